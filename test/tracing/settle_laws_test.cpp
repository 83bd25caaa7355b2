// Beside effects an actuator keeps the law near rest of the baseline where held-back blocks say so.
#include "src/tracing/settle_laws.h"

#include "src/tracing/refit.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class SettleLaws : public SearchedMachine {
 protected:
  /// An effect that is really there: without any, laws are the baseline's.
  void findLoadFriction() {
    FoundEffect friction;
    friction.hypothesis = named("load_dependent_friction", {0.0});
    has(friction.hypothesis, Eigen::VectorXd::Constant(1, 0.1));
    search_.effects = {friction};
    refit(search_);
  }
};

TEST_F(SettleLaws, OfTheBaselineComeBackWhereTheChoiceBesideEffectsLeavesMore) {
  const BaseFit baseline = base_;
  findLoadFriction();
  const Eigen::VectorXd right_N = search_.rms_N;
  rubBy(dynamics::smoothLaw(4e-3));
  ASSERT_GT(search_.rms_N[kActuator], 1.5 * right_N[kActuator]);
  EXPECT_TRUE(settleLaws(search_, baseline));
  EXPECT_EQ(base_.friction_laws[kActuator], baseline.friction_laws[kActuator]);
  EXPECT_NEAR(search_.rms_N[kActuator], right_N[kActuator], 0.01 * right_N[kActuator]);
  ASSERT_EQ(search_.effects.size(), 1u);
  EXPECT_NEAR(search_.effects[0].coefficients[0], 0.1, 0.02);
}

TEST_F(SettleLaws, ChosenBesideEffectsStayWhereTheBaselinesLeaveMore) {
  const BaseFit right = base_;
  findLoadFriction();
  BaseFit baseline = base_;
  baseline.friction_laws[kActuator] = dynamics::smoothLaw(4e-3);
  const Eigen::VectorXd left_N = search_.rms_N;
  EXPECT_FALSE(settleLaws(search_, baseline));
  EXPECT_EQ(base_.friction_laws[kActuator], right.friction_laws[kActuator]);
  EXPECT_NEAR(search_.rms_N[kActuator], left_N[kActuator], 1e-3 * left_N[kActuator]);
}

TEST_F(SettleLaws, WithoutEffectsAreLeftAlone) {
  BaseFit baseline = base_;
  baseline.friction_laws[kActuator] = dynamics::smoothLaw(4e-3);
  EXPECT_FALSE(settleLaws(search_, baseline));
}

}  // namespace
}  // namespace knee_robot::tracing
