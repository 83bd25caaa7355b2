// What an effect explains is said of the model that was settled on.
#include <cmath>

#include "src/tracing/refit.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class Explained : public SearchedMachine {
 protected:
  /// Of a gain that makes a fifth of one actuator's force, when so much was said of it where it was found.
  Eigen::VectorXd saidInTheEnd(double found_N, double p) {
    FoundEffect gain;
    gain.hypothesis = named("force_gain", {});
    gain.p = p;
    gain.explained_rms_N = Eigen::VectorXd::Constant(data_.stack.axes, found_N);
    search_.effects = {gain};
    refit(search_);
    explainAnew(search_);
    return search_.effects.front().explained_rms_N;
  }
};

TEST_F(Explained, IsWhatIsMissingWithoutItInTheEnd) {
  has(named("force_gain", {}), Eigen::VectorXd::Constant(1, 0.2));
  const Eigen::VectorXd said_N = saidInTheEnd(0.1, 0.004);
  EXPECT_NEAR(said_N[kActuator], explainedBy(search_, 0)[kActuator], 1e-9);
  EXPECT_GT(said_N[kActuator], 1.0);
  EXPECT_LT(said_N[0], 0.5) << "what the baseline does to others";
}

TEST_F(Explained, StaysWhereMoreWasSaidOrAModelWasGiven) {
  has(named("force_gain", {}), Eigen::VectorXd::Constant(1, 0.2));
  EXPECT_EQ(saidInTheEnd(1e3, 0.004)[kActuator], 1e3);
  EXPECT_EQ(saidInTheEnd(0.1, std::nan(""))[kActuator], 0.1);
}

}  // namespace
}  // namespace knee_robot::tracing
