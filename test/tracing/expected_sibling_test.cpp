// What several actuators have is looked for on the others below an estimated noise floor, too.
#include "src/tracing/trial.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

/// A drag on one actuator that lowers its residual by a twentieth, from a fifth below the noise floor.
class ExpectedSibling : public SearchedMachine {
 protected:
  std::string objectionWith(int carriers, bool measured) {
    search_.floor.rms_N = 1.2 * search_.rms_N;
    search_.floor.of_names_N = search_.floor.rms_N;
    search_.floor.measured = measured;
    const Hypothesis drag = named("quadratic_drag", {});
    search_.effects.assign(static_cast<std::size_t>(carriers), {});
    for (FoundEffect& e : search_.effects)
      e.hypothesis = {{drag.place.candidate, kActuator + 1}, {}};
    Trial t;
    t.hypothesis = drag;
    t.share = 10.0;
    t.fit.residual_N.resize(data_.stack.axes * data_.stack.size());
    for (int i = 0; i < data_.stack.axes; ++i)
      t.fit.residual_N.segment(i * data_.stack.size(), data_.stack.size()).setConstant(0.95 * search_.rms_N[i]);
    t.fit.coefficients = {Eigen::VectorXd::Constant(1, 100.0)};
    t.fit.stable = {1};
    t.gain = t.joint_gain = t.nested_gain = Eigen::VectorXd::LinSpaced(12, 0.9, 1.1);
    t.held = heldBackGain(t.gain);
    return objection(search_, t, true);
  }
  const std::string at_the_floor_ = "does not lower the residual by a tenth where it is above the floor";
};

TEST_F(ExpectedSibling, IsAddedBelowAFloorThatIsAnEstimateWhereTwoOthersHaveIt) {
  EXPECT_EQ(objectionWith(2, false), "");
}

TEST_F(ExpectedSibling, IsNotAddedThereWhereOneOtherHasIt) {
  EXPECT_EQ(objectionWith(1, false), at_the_floor_);
}

TEST_F(ExpectedSibling, IsNotAddedBelowAFloorThatRepeatsMeasured) {
  EXPECT_EQ(objectionWith(2, true), at_the_floor_);
}

}  // namespace
}  // namespace knee_robot::tracing
