// The whole controller on the simulated robot A, enabled with encoders that do not count and a load that nobody declared:
// the brakes open, and no loop sees the platform sink.
#include "holding_robot.h"

namespace knee_robot::control {
namespace {

using namespace holding;

TEST(BlindAtEnabling, IsFoundBeforeAnUndeclaredLoadHasTakenThePlatformDownByACentimetre) {
  for (const unsigned blind : {1u, 2u, 4u, 8u, 15u}) {
    for (const double payload_kg : {0.0, 15.0}) {
      Truth truth;
      truth.payload_kg = payload_kg;
      truth.blind = static_cast<std::uint8_t>(blind);
      HoldingRobot robot(truth);
      const ControlStatus status = robot.system->status();
      std::printf("encoders %2u, %2.0f kg: %.1f mm, %s\n", blind, payload_kg, 1e3 * (robot.stood - robot.lowest),
                  status.fault_name.c_str());
      EXPECT_EQ(status.fault_name, "encoder_frozen");
      EXPECT_FALSE(status.homed);
      EXPECT_LT(robot.stood - robot.lowest, 0.01) << "encoders " << blind << ", " << payload_kg << " kg";  // once 93 mm
    }
  }
}

TEST(BlindAtEnabling, HealthyRobotsAreNotMovedByIt) {
  for (const double payload_kg : {0.0, 15.0}) {
    Truth truth;
    truth.payload_kg = payload_kg;
    HoldingRobot robot(truth);
    EXPECT_EQ(robot.system->state(), MachineState::Holding) << robot.system->status().fault_sentence;
    EXPECT_LT(robot.stood - robot.lowest, payload_kg > 0.0 ? 0.004 : 0.001);
  }
}

}  // namespace
}  // namespace knee_robot::control
