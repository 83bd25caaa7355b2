// A machine's first power-up as docs/machine.md has it: one axis after the other, the other drives without power, what
// the platform weighs carried by a crane.
#include "holding_robot.h"

namespace knee_robot::control {
namespace {

using namespace holding;

Truth oneAxis(std::size_t axis, const char* deployment) {
  Truth truth;
  truth.carried = true;
  truth.dead = static_cast<std::uint8_t>(0x0F & ~(1u << axis));
  truth.deployment = deployment;
  return truth;
}

/// Begins to move one axis by 2 mm within 4 s.
void playTwoMillimetres(HoldingRobot& robot, std::size_t axis) {
  trajectory::Reference reference;
  reference.name = "two_millimetres";
  reference.points.resize(401, 4);
  const AxisValues from = robot.system->snapshot()->reference_m;
  for (int k = 0; k <= 400; ++k) {
    for (std::size_t i = 0; i < 4; ++i)
      reference.points(k, static_cast<Eigen::Index>(i)) = from[i];
    reference.points(k, static_cast<Eigen::Index>(axis)) += 0.001 * (1.0 - std::cos(M_PI * k / 400.0));
  }
  ASSERT_TRUE(robot.system->loadReference(reference).ok);
  ASSERT_TRUE(robot.system->play().ok);
}

TEST(Commissioning, OneAxisHoldsAndMovesWhileTheOtherDrivesHaveNoPower) {
  for (std::size_t axis = 0; axis < 4; ++axis) {
    HoldingRobot robot(oneAxis(axis, "config/deployment/commissioning.yaml"));
    robot.system->run(57.0);
    ASSERT_EQ(robot.system->state(), MachineState::Holding) << axis << ": " << robot.system->status().fault_sentence;
    const AxisValues before = robot.system->snapshot()->position_m;
    playTwoMillimetres(robot, axis);
    robot.system->run(6.0);
    EXPECT_EQ(robot.system->state(), MachineState::Holding) << axis << ": " << robot.system->status().fault_sentence;
    // A tenth of the gains: leg 4's 60 N of friction are 10 mm of P alone.
    EXPECT_NEAR(robot.system->snapshot()->position_m[axis] - before[axis], 0.002, 0.001) << axis;
  }
}

TEST(Commissioning, AForceSignThatIsWrongEndsInAFaultWithinMillimetres) {
  for (std::size_t axis = 0; axis < 4; ++axis) {
    Truth truth = oneAxis(axis, "config/deployment/commissioning.yaml");
    truth.reversed = static_cast<std::uint8_t>(1u << axis);
    HoldingRobot robot(truth);
    const double before = robot.system->snapshot()->position_m[axis];
    playTwoMillimetres(robot, axis);
    EXPECT_TRUE(robot.system->waitFor(MachineState::Faulted, 20.0)) << axis;
    const double moved = std::abs(robot.system->snapshot()->position_m[axis] - before);
    EXPECT_LT(moved, 0.01) << axis;
    std::printf("leg %zu, reversed: %s after %.1f mm\n", axis + 1, robot.system->status().fault_name.c_str(),
                1e3 * moved);
  }
}

TEST(Commissioning, IsRefusedByTheOrdinaryDeploymentWhereAxesWithoutPowerDoNotAnswer) {
  HoldingRobot robot(oneAxis(0, "config/deployment/simulation.yaml"));
  EXPECT_TRUE(robot.system->waitFor(MachineState::Faulted, 20.0));
}

}  // namespace
}  // namespace knee_robot::control
