#pragma once

#include <memory>

#include "knee_robot/hardware/can/can_settings.h"
#include "knee_robot/simulation/drive_model.h"
#include "knee_robot/simulation/robot_simulation.h"

namespace knee_robot::simulation {

/// The simulated robot behind four simulated CiA 402 drives on a bus instead of cards: the drives' torques move the
/// plant, their position objects follow it. A drive that is not in Operation Enabled gives no force. A digital output
/// (holding brakes, heartbeat) counts only when all four drives set it; the emergency stop's input is on every drive.
class CanRobot {
 public:
  using Units = std::array<hardware::can::AxisUnits, hardware::kAxes>;

  /// Screws and set values are those of `units`; node numbers, rated torque and currents are those of `settings`, so
  /// that the drives are what the hardware file describes; all other objects come from the table. `image` and `bus`
  /// must outlive this. Throws InputError.
  CanRobot(const mechanism::Robot& robot, const dynamics::RobotInertia& inertia, const SimulationParameters& parameters,
           const hardware::can::CanSettings& settings, const Units& units, const hardware::can::ObjectDictionary& table,
           RobotImage& image, hardware::can::FramePort& bus);

  void powerUp() noexcept;
  /// A frame from the bus, to all drives.
  void take(const hardware::can::Frame& frame) noexcept;
  /// The bus' clock goes on: heartbeats, quick stops.
  void stepDrives(std::int64_t now) noexcept;
  /// Advances the plant by dt (s). False when it left the numbers.
  bool stepPlant(double dt) noexcept;

  DriveModel& drive(std::size_t axis) { return *drives_.at(axis); }
  RobotSimulation& simulation() noexcept { return simulation_; }

 private:
  void readDrives() noexcept;
  void tellDrives() noexcept;

  Units units_;
  std::array<std::unique_ptr<DriveModel>, hardware::kAxes> drives_;
  std::array<double, hardware::kAxes> volts_{};
  const int drive_enable_bit_;
  RobotImage& image_;
  RobotSimulation simulation_;
};

}  // namespace knee_robot::simulation
