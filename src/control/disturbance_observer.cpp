#include "knee_robot/control/disturbance_observer.h"

#include <algorithm>

namespace knee_robot::control {
namespace {

constexpr double kLongestStep_s = 0.005;  // after a pause of the machine

}  // namespace

DisturbanceObserver::DisturbanceObserver(const std::string& name, const mechanism::Robot& robot)
    : rt::TaskContext(name), robot_(robot), inputs_{&command_1, &command_2, &command_3, &command_4} {}

bool DisturbanceObserver::configureHook() {
  if (robot_.axes() != hardware::kAxes) return refuse("the observer is for four axes");
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    count_m_[i] = robot_.actuators[i].metresPerCount();
  return true;
}

bool DisturbanceObserver::startHook() {
  rest_.reset();
  return true;
}

void DisturbanceObserver::readPorts() noexcept {
  new_reading_ = measurement.read(measured_) == rt::FlowStatus::NewData && measured_.status == hardware::IoStatus::Ok;
  orders.read(order_);
  written.read(written_);
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    inputs_[i]->read(commands_[i]);
}

bool DisturbanceObserver::rests() const noexcept {
  if (order_.level != DriveLevel::Released || order_.safe_stop || order_.homing != 0) return false;
  return std::all_of(commands_.begin(), commands_.end(),
                     [](const AxisCommand& command) { return command.active && command.at_rest; });
}

void DisturbanceObserver::updateHook(const rt::Cycle& cycle) {
  readPorts();
  const double dt = std::clamp(rt::toSeconds(cycle.time - last_time_), 0.0, kLongestStep_s);
  last_time_ = cycle.time;
  if (new_reading_) {
    RestWatch::Axes error_m{};
    bool pulses = false;
    for (std::size_t i = 0; i < hardware::kAxes; ++i) {
      error_m[i] = commands_[i].reference_m - measured_.position_m[i];
      pulses = pulses || commands_[i].test_pulse;
    }
    if (rest_.step(rests(), pulses, dt, error_m, count_m_)) ++out_.suspicion;
  }
  out_.sequence = measured_.sequence;
  out_.time = cycle.time;
  disturbance.write(out_);
}

}  // namespace knee_robot::control
