// A baseline is fitted anew beside effects where they have changed, and stays where they hardly have.
#include "src/tracing/refit.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class Rebase : public SearchedMachine {
 protected:
  Rebase() { search_.options = &options_; }
  void find(const Hypothesis& hypothesis) {
    FoundEffect effect;
    effect.hypothesis = hypothesis;
    search_.effects.push_back(effect);
    refit(search_);
  }

  const TraceOptions options_;
};

TEST_F(Rebase, LeavesABaselineAsItIsUntilItsEffectsChange) {
  const Hypothesis drag = named("quadratic_drag", {});
  has(drag, Eigen::VectorXd::Constant(1, 300.0));
  find(drag);
  EXPECT_TRUE(base_.beside.level.empty()) << "not yet fitted beside anything";
  rebase(search_);
  rebase(search_);
  const Eigen::VectorXd parameters = base_.parameters;
  EXPECT_GT(base_.beside.force_N[0].col(kActuator).norm(), 0.0);
  EXPECT_EQ(base_.beside.without_peak, std::vector<char>({0, 1, 0, 0})) << "no new peak beside friction";
  EXPECT_FALSE(rebase(search_));
  EXPECT_EQ((base_.parameters - parameters).norm(), 0.0) << "not fitted anew";
  search_.effects.clear();
  find(named("force_gain", {}));
  rebase(search_);
  EXPECT_GT((base_.parameters - parameters).norm(), 0.0);
  EXPECT_EQ(base_.beside.without_peak, std::vector<char>({0, 0, 0, 0})) << "a gain is no friction";
}

/// Taken off as it was fitted beside another law, the effect would bring that law back.
TEST_F(Rebase, FindsTheLawBesideAnEffectThatWasFittedBesideAnother) {
  const dynamics::FrictionLaw right = base_.friction_laws[kActuator];
  const Eigen::VectorXd right_N = search_.rms_N;
  const Hypothesis drag = named("quadratic_drag", {});
  has(drag, Eigen::VectorXd::Constant(1, 2000.0));
  rubBy(dynamics::smoothLaw(8e-3));
  find(drag);
  ASSERT_GT(std::abs(search_.effects[0].coefficients[0] - 2000.0), 100.0);
  rebase(search_);
  EXPECT_EQ(base_.friction_laws[kActuator].elements[0].smooth, right.elements[0].smooth);
  EXPECT_NEAR(search_.effects[0].coefficients[0], 2000.0, 60.0);
  EXPECT_LT(search_.rms_N[kActuator], 1.05 * right_N[kActuator]);
}

}  // namespace
}  // namespace knee_robot::tracing
