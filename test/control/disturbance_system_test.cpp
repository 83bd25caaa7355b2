// The whole controller on the simulated robot A, stepped, at rest: nobody is shaken while nothing happens, and a push finds a dead encoder.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "knee_robot/control/control_system.h"
#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/simulation/robot_simulation.h"
#include "knee_robot/simulation/simulated_cards.h"

namespace knee_robot::control {
namespace {

std::string file(const std::string& name) {
  return std::string(KNEE_SOURCE_DIR) + "/" + name;
}

struct HoldingRobot {
  HoldingRobot()
      : robot(mechanism::loadRobot(file("config/robots/A.yaml"))),
        plant(robot, dynamics::loadRobotInertia(robot),
              simulation::loadSimulationParameters(file("config/simulation/A.yaml")), image),
        bus(simulation::openImageCards(image)) {
    ControlSystem::Options options;
    options.empty = true;
    options.execution = rt::Execution::Stepped;
    system = std::make_unique<ControlSystem>(robot, loadHardwareFile(file("config/hardware/simulated.yaml")),
                                             file("config/deployment/simulation.yaml"), *bus, options);
    system->setPlant([this](rt::Nanoseconds time) {
      while (plant.time() + 0.0005 < 1e-9 * static_cast<double>(time))
        plant.step(0.001);
      lowest = std::min(lowest, plant.state().pose[1]);
    });
    EXPECT_TRUE(system->start().ok);
    EXPECT_TRUE(system->enable().ok);
    system->run(3.0);  // every encoder has been asked once
  }
  void freeze(std::size_t axis) {
    image.faults.encoder[axis].store(static_cast<std::uint8_t>(simulation::EncoderFault::Frozen));
  }
  void push(double newton) { image.surroundings.pose_force[1].store(-newton); }

  mechanism::Robot robot;
  simulation::RobotImage image;
  simulation::RobotSimulation plant;
  std::unique_ptr<hardware::AxisBus> bus;
  std::unique_ptr<ControlSystem> system;
  double lowest = 10.0;
};

TEST(Disturbance, NobodyIsShakenWhileNothingHappens) {
  HoldingRobot robot;
  const mechanism::Pose before = robot.plant.state().pose;
  double farthest = 0.0;
  for (int k = 0; k < 20000; ++k) {
    robot.system->step();
    farthest = std::max(farthest, (robot.plant.state().pose - before).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(farthest, 2e-5) << "m, rad; in 20 s";
  EXPECT_EQ(robot.system->state(), MachineState::Holding);
}

TEST(Disturbance, APushOf150NewtonFindsAnyFrozenEncoderBeforeThePlatformHasSunkBy5Millimetres) {
  for (std::size_t axis = 0; axis < hardware::kAxes; ++axis) {
    for (const double later_s : {0.0, 1.0}) {
      HoldingRobot robot;
      const double height = robot.plant.state().pose[1];
      robot.freeze(axis);
      robot.system->run(later_s);
      robot.push(150.0);
      robot.system->waitFor(MachineState::Faulted, 3.0);
      const ControlStatus status = robot.system->status();
      EXPECT_EQ(status.fault, Fault::EncoderFrozen) << "axis " << axis + 1 << ": " << status.fault_name;
      EXPECT_EQ(status.fault_axis, static_cast<int>(axis) + 1);
      EXPECT_LT(height - robot.lowest, 0.005) << "axis " << axis + 1 << ", push " << later_s << " s later";
    }
  }
}

TEST(Disturbance, AHealthyRobotHoldsAgainstTheSamePush) {
  HoldingRobot robot;
  const double height = robot.plant.state().pose[1];
  for (int k = 0; k < 5; ++k) {
    robot.push(150.0);
    robot.system->run(1.0);
    robot.push(0.0);
    robot.system->run(1.0);
  }
  EXPECT_EQ(robot.system->state(), MachineState::Holding) << robot.system->status().fault_sentence;
  EXPECT_LT(height - robot.lowest, 0.003);
}

}  // namespace
}  // namespace knee_robot::control
