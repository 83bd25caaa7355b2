#pragma once

#include <cmath>

#include "knee_robot/base/files.h"
#include "knee_robot/control/control_system.h"
#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/simulation/can_robot.h"
#include "test/hardware/can_bench.h"

namespace knee_robot::fake {

/// The whole controller, stepped, on four simulated CiA 402 drives on a bus in this process, which move the simulated
/// robot A.
class CanRig {
 public:
  CanRig()
      : robot(mechanism::loadRobot(file("config/robots/A.yaml"))),
        hardware(control::loadHardwareFile(file("config/hardware/can_simulated.yaml"))),
        plant(robot, dynamics::loadRobotInertia(robot),
              simulation::loadSimulationParameters(file("config/simulation/A.yaml")), *hardware.can,
              control::canUnits(robot), hardware::can::driveTable(), image, wire.drivesPort()),
        bus(wire.addPort(hardware::can::processFilters(*hardware.can)),
            wire.addPort(hardware::can::serviceFilters(*hardware.can)), *hardware.can, control::canUnits(robot)),
        system(robot, hardware, file("config/deployment/can.yaml"), bus, stepped()) {
    wire.to_drives = [this](const hardware::can::Frame& frame) { plant.take(frame); };
    wire.on_time = [this](std::int64_t now) {
      plant.stepDrives(now);
      if (++half_milliseconds_ % 2 == 0) plant.stepPlant(1e-3);
    };
    system.setPlant([this](rt::Nanoseconds time) {
      if (last_ != 0) wire.advance(time - last_);
      last_ = time;
    });
  }

  static std::string file(const std::string& name) { return std::string(KNEE_SOURCE_DIR) + "/" + name; }
  static control::ControlSystem::Options stepped() {
    control::ControlSystem::Options options;
    options.execution = rt::Execution::Stepped;
    return options;
  }

  control::Answer hold() {
    control::Answer answer = system.start();
    if (answer.ok) answer = system.enable();
    if (answer.ok) system.run(0.5);
    return answer;
  }
  /// In the middle of a motion of `distance` up in all legs, rest to rest.
  control::Answer play(double distance = 0.02, double seconds = 4.0) {
    control::Answer answer = hold();
    if (answer.ok) answer = system.loadReference(lift(distance, seconds));
    if (answer.ok) answer = system.play();
    if (answer.ok) system.run(seconds / 2);
    return answer;
  }
  trajectory::Reference lift(double distance, double seconds) const {
    trajectory::Reference reference;
    reference.name = "lift";
    const auto intervals = static_cast<Eigen::Index>(std::lround(seconds / 0.01));
    reference.points.resize(intervals + 1, 4);
    for (Eigen::Index k = 0; k <= intervals; ++k) {
      const double x = static_cast<double>(k) / static_cast<double>(intervals);
      const double share = x * x * x * (10.0 + x * (6.0 * x - 15.0));
      for (int i = 0; i < 4; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        reference.points(k, i) = robot.actuators[axis].home_length_m + share * distance;
      }
    }
    return reference;
  }
  unsigned brakesEngaged() const { return image.status.brakes_engaged.load(); }
  unsigned drivesEnabled() const { return image.status.drives_enabled.load(); }

  mechanism::Robot robot;
  control::HardwareFile hardware;
  simulation::RobotImage image;
  hardware::can::BenchBus wire;
  simulation::CanRobot plant;
  hardware::can::CanAxisBus bus;
  control::ControlSystem system;

 private:
  std::int64_t last_ = 0;
  int half_milliseconds_ = 0;
};

/// What a case does where it does nothing.
inline void nothing(CanRig&) {}

}  // namespace knee_robot::fake
