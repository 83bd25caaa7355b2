#pragma once

#include <cmath>

#include "knee_robot/base/files.h"
#include "knee_robot/control/control_system.h"
#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/simulation/can_robot.h"
#include "test/hardware/can_bench.h"

namespace knee_robot::fake {

/// The whole controller, stepped, on four simulated CiA 402 drives on a bus in this process, which move the simulated robot A.
class CanRig {
 public:
  CanRig()
      : robot(loadRobot(file("config/robots/A.yaml"))),
        hardware(loadHardwareFile(file("config/hardware/can_simulated.yaml"))),
        plant(robot, loadRobotInertia(robot), loadSimulationParameters(file("config/simulation/A.yaml")), *hardware.can,
              canUnits(robot), hardware::can::driveTable(), image, wire.drivesPort()),
        bus(wire.addPort(hardware::can::processFilters(*hardware.can)),
            wire.addPort(hardware::can::serviceFilters(*hardware.can)), *hardware.can, canUnits(robot)),
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
  static ControlSystem::Options stepped() {
    ControlSystem::Options options;
    options.execution = rt::Execution::Stepped;
    return options;
  }

  Answer hold() {
    Answer answer = system.start();
    if (answer.ok) answer = system.enable();
    if (answer.ok) system.run(0.5);
    return answer;
  }
  /// In the middle of a motion of `distance` up in all legs, rest to rest.
  Answer play(double distance = 0.02, double seconds = 4.0) {
    Answer answer = hold();
    if (answer.ok) answer = system.loadReference(lift(distance, seconds));
    if (answer.ok) answer = system.play();
    if (answer.ok) system.run(seconds / 2);
    return answer;
  }
  Reference lift(double distance, double seconds) const {
    Reference reference;
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

  Robot robot;
  HardwareFile hardware;
  hardware::RobotImage image;
  hardware::can::BenchBus wire;
  CanRobot plant;
  hardware::can::CanAxisBus bus;
  ControlSystem system;

 private:
  std::int64_t last_ = 0;
  int half_milliseconds_ = 0;
};

}  // namespace knee_robot::fake
