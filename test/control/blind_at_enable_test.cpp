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

/// How far a leg of a robot with 15 kg goes whose encoder `axis` dies `late_s` after its brake has opened.
double goesOn(const std::string& name, std::size_t axis, double late_s) {
  Truth truth;
  truth.payload_kg = 15.0;
  truth.robot = name;
  const mechanism::Robot robot = mechanism::loadRobot(file("config/robots/" + name + ".yaml"));
  simulation::RobotImage image;
  simulation::RobotSimulation plant(robot, dynamics::loadRobotInertia(robot), parameters(truth), image);
  const std::unique_ptr<hardware::AxisBus> bus = simulation::openImageCards(image);
  ControlSystem::Options options;
  options.empty = true;
  options.execution = rt::Execution::Stepped;
  ControlSystem system(robot, loadHardwareFile(file("config/hardware/simulated.yaml")), file(truth.deployment), *bus,
                       options);
  const mechanism::Lengths from = plant.lengths();
  double farthest = 0.0, opened_s = 1e9;
  system.setPlant([&](rt::Nanoseconds time) {
    while (plant.time() + 0.0005 < 1e-9 * static_cast<double>(time)) {
      plant.step(0.001);
      farthest = std::max(farthest, (plant.lengths() - from).cwiseAbs().maxCoeff());
      if (image.status.brakes_engaged.load() == 0) opened_s = std::min(opened_s, plant.time());
      if (plant.time() >= opened_s + late_s)
        image.faults.encoder[axis].store(static_cast<std::uint8_t>(simulation::EncoderFault::Frozen));
    }
  });
  EXPECT_TRUE(system.start().ok);
  system.enable();
  system.run(2.5);
  EXPECT_EQ(system.status().fault_name, "encoder_frozen") << name << ", axis " << axis + 1 << ", " << late_s;
  return farthest;
}

TEST(BlindAtEnabling, OrWithinTheFirstTenthsOfASecondIsFoundAsSoon) {
  double farthest = 0.0;
  for (const std::string name : {"A", "final"}) {
    for (std::size_t axis = 0; axis < hardware::kAxes; ++axis) {
      for (const double late_s : {0.0, 0.02, 0.04, 0.06, 0.08, 0.1, 0.15, 0.2, 0.3})
        farthest = std::max(farthest, goesOn(name, axis, late_s));
    }
  }
  std::printf("a leg goes %.1f mm at most\n", 1e3 * farthest);
  EXPECT_LT(farthest, 0.01)
      << "once 101 mm: an encoder that had counted while its brake opened was left alone for 0.5 s";
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
