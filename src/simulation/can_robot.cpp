#include "knee_robot/simulation/can_robot.h"

#include <cmath>

namespace knee_robot::simulation {
namespace {

namespace objects = hardware::can::objects;

hardware::can::ObjectDictionary dictionaryFor(hardware::can::ObjectDictionary table,
                                              const hardware::can::CanSettings& settings, std::size_t axis) {
  const hardware::can::DriveSettings& drive = settings.drives[axis];
  const auto scaled = [](double value, double unit) { return std::llround(value / unit); };
  table.set(objects::kVendor, settings.vendor);
  table.set(objects::kProduct, settings.product);
  table.set(objects::kSerial, drive.serial.value_or(static_cast<std::uint32_t>(axis + 1)));
  table.set(objects::kRatedTorque, scaled(drive.rated_torque_Nm, 1e-6));
  table.set(objects::kNominalCurrent, scaled(drive.nominal_current_A, 1e-3));
  table.set(objects::kCurrentLimit, scaled(drive.current_limit_A, 1e-3));
  return table;
}

}  // namespace

CanRobot::CanRobot(const mechanism::Robot& robot, const dynamics::RobotInertia& inertia,
                   const SimulationParameters& parameters, const hardware::can::CanSettings& settings,
                   const Units& units, const hardware::can::ObjectDictionary& table, RobotImage& image,
                   hardware::can::FramePort& bus)
    : units_(units),
      drive_enable_bit_(parameters.drive_enable_bit),
      image_(image),
      simulation_(robot, inertia, parameters, image) {
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    units_[i].rated_torque_Nm = settings.drives[i].rated_torque_Nm;
    drives_[i] = std::make_unique<DriveModel>(settings.drives[i].node, dictionaryFor(table, settings, i), bus);
  }
  simulation_.takeVoltsFrom(volts_);
  tellDrives();
}

void CanRobot::powerUp() noexcept {
  for (const auto& drive : drives_)
    drive->powerUp();
}

void CanRobot::take(const hardware::can::Frame& frame) noexcept {
  for (const auto& drive : drives_)
    drive->take(frame);
}

void CanRobot::stepDrives(std::int64_t now) noexcept {
  for (const auto& drive : drives_)
    drive->step(now);
}

void CanRobot::readDrives() noexcept {
  bool any_enabled = false;
  unsigned common = 0x0F;
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const DriveModel& drive = *drives_[i];
    any_enabled = any_enabled || drive.state() == hardware::can::DriveState::OperationEnabled;
    volts_[i] = hardware::can::voltsOf(drive.torque(), units_[i]);
    common &= drive.outputs();
  }
  const unsigned enable = 1u << drive_enable_bit_;
  image_.counter.outputs.store(static_cast<std::uint8_t>((common & ~enable) | (any_enabled ? enable : 0u)));
}

void CanRobot::tellDrives() noexcept {
  const auto counts = publishedCounts(image_.counter);
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    drives_[i]->setPosition(static_cast<std::int32_t>(counts[i]));
    drives_[i]->setInputs(image_.counter.inputs.load());
  }
}

bool CanRobot::stepPlant(double dt) noexcept {
  readDrives();
  const bool good = simulation_.step(dt);
  tellDrives();
  return good;
}

}  // namespace knee_robot::simulation
