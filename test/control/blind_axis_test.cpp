// The whole controller on the simulated robot A while it moves: an encoder that dies, and a brake that closes, at many
// places of a path with turning points. Both leave an axis without a count; the other axes tell which it is.
#include "holding_robot.h"

namespace knee_robot::control {
namespace {

using namespace holding;

struct Found {
  std::string fault;
  int axis = 0;
  double drop_m = 0.0;
};

/// `bring` about what happens to `axis` at `time_s` of the path.
template <typename Bring>
Found foundWhileMoving(std::size_t axis, double time_s, double payload_kg, Bring&& bring) {
  Truth truth;
  truth.payload_kg = payload_kg;
  HoldingRobot robot(truth);
  robot.swing();
  robot.system->run(time_s);
  EXPECT_EQ(robot.system->state(), MachineState::Playing) << robot.system->status().fault_sentence;
  const double height = robot.lowest = robot.plant.state().pose[1];
  bring(robot.image.faults, axis);
  robot.system->waitFor(MachineState::Faulted, 3.0);
  const ControlStatus status = robot.system->status();
  return {status.fault_name, status.fault_axis, height - robot.lowest};
}

void freeze(simulation::InjectedFaults& faults, std::size_t axis) {
  faults.encoder[axis].store(static_cast<std::uint8_t>(simulation::EncoderFault::Frozen));
}
void closeBrake(simulation::InjectedFaults& faults, std::size_t axis) {
  faults.hold_closed.store(static_cast<std::uint8_t>(1u << axis));
}

TEST(BlindAxis, AnEncoderThatDiesInMotionIsFoundBeforeThePlatformHasSunkBy5MillimetresTurningPointsIncluded) {
  for (std::size_t axis = 0; axis < hardware::kAxes; ++axis) {
    for (double time_s = 0.3; time_s < 3.2; time_s += 0.21) {
      const Found found = foundWhileMoving(axis, time_s, 0.0, freeze);
      EXPECT_EQ(found.fault, "encoder_frozen") << "axis " << axis + 1 << " at " << time_s << " s";
      EXPECT_EQ(found.axis, static_cast<int>(axis) + 1) << "at " << time_s << " s";
      EXPECT_LT(found.drop_m, 0.005) << "axis " << axis + 1 << " at " << time_s << " s";
    }
  }
}

TEST(BlindAxis, ABrakeThatClosesIsMostlyToldFromADeadEncoder) {
  int blocked = 0, all = 0;
  for (std::size_t axis = 0; axis < hardware::kAxes; ++axis) {
    for (double time_s = 0.4; time_s < 3.2; time_s += 0.53) {
      const Found found = foundWhileMoving(axis, time_s, 15.0, closeBrake);
      EXPECT_TRUE(found.fault == "axis_blocked" || found.fault == "encoder_frozen")
          << found.fault << " of axis " << found.axis << " instead of " << axis + 1 << " at " << time_s << " s";
      EXPECT_LT(found.drop_m, 0.005);
      blocked += found.fault == "axis_blocked" ? 1 : 0;
      ++all;
    }
  }
  std::printf(
      "%d of %d closed brakes were called axis_blocked, the others encoder_frozen (whose sentence names both)\n",
      blocked, all);
  EXPECT_GE(blocked, all * 2 / 3);
}

}  // namespace
}  // namespace knee_robot::control
