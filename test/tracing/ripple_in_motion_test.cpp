// A ripple goes on wherever its screw turns: what only the stops show is none.
#include <cmath>

#include "src/tracing/decide.h"
#include "src/tracing/refit.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class RippleInMotion : public SearchedMachine {
 protected:
  /// A ripple that is in the model: forces as one would add them, times `factor` of every row.
  void found(const Eigen::VectorXd& factor) {
    FoundEffect e;
    e.hypothesis = named("screw_ripple", {0.005});
    const Eigen::MatrixXd rows = effectRows(data_, e.hypothesis);
    data_.all_force_rows += factor.cwiseProduct(rows.rowwise().sum() * (3.0 / std::sqrt(2.0)));
    setAttention(data_, Attention::All);
    search_.effects.push_back(e);
    refit(search_);
  }
};

TEST_F(RippleInMotion, ThatGoesOnWhileTheAxisMovesStays) {
  found(Eigen::VectorXd::Ones(data_.all_force_rows.size()));
  dropWhatDoesNotRepeat(search_);
  EXPECT_EQ(search_.effects.size(), 1u);
  EXPECT_TRUE(search_.taken_out.empty());
}

TEST_F(RippleInMotion, ThatOnlyStopsShowIsTakenOutAndSaid) {
  const Eigen::ArrayXd weight = rowScale(data_.stack, data_.recordings, Attention::Moving).array();
  found((weight < 0.5 * weight.maxCoeff()).cast<double>());
  dropWhatDoesNotRepeat(search_);
  EXPECT_TRUE(search_.effects.empty());
  ASSERT_EQ(search_.taken_out.size(), 1u);
  EXPECT_NE(search_.taken_out[0].find("while axes move"), std::string::npos) << search_.taken_out[0];
}

}  // namespace
}  // namespace knee_robot::tracing
