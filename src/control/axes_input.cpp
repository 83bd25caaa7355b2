#include "axes_input.h"

#include "knee_robot/base/constants.h"

namespace knee_robot::control {

AxesInput::AxesInput(const std::string& name, const mechanism::Robot& robot, hardware::AxisBus& bus,
                     const AxisValues& lengths_at_start)
    : rt::TaskContext(name), bus_(bus), lengths_at_start_(lengths_at_start) {
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const mechanism::Actuator& actuator = robot.actuators.at(i);
    metres_per_count_[i] = actuator.encoder_sign * actuator.metresPerCount();
  }
}

bool AxesInput::startHook() {
  // The counters were reset by the self test: what they show is what has been moved since. Started anew without a self
  // test, the unwrapped counts go on from where they were.
  out_.status = hardware::IoStatus::NotReady;
  return true;
}

void AxesInput::updateHook(const rt::Cycle& cycle) {
  hardware::AxisFeedback feedback;
  out_.status = bus_.read(feedback);
  HomeSetting setting;
  if (home.read(setting) == rt::FlowStatus::NewData && setting.number != home_number_) {
    home_number_ = out_.home_number = setting.number;
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      lengths_at_start_[i] += setting.shift_m[i];
  }
  ++out_.sequence;
  out_.time = cycle.time;
  out_.read_at = cycle.wake;
  out_.fenced_out = bus_.isFencedOut();
  out_.guardian_carries = bus_.isCarriedByGuardian();
  out_.bus_failure = bus_.failure();
  if (out_.status == hardware::IoStatus::Ok) {
    // By when it was read, not by when it was planned: a late cycle is no faster motion.
    convert(feedback, any_ ? rt::toSeconds(cycle.wake - last_good_) : 0.0);
    last_good_ = cycle.wake;
    any_ = true;
  }
  measurement.write(out_);
}

void AxesInput::convert(const hardware::AxisFeedback& feedback, double dt) {
  const double tau = 1.0 / (kTwoPi * velocity_cutoff);
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const std::int32_t moved = hardware::countDifference(feedback.counts[i], last_counts_[i]);
    last_counts_[i] = feedback.counts[i];
    out_.counts[i] += moved;
    out_.position_m[i] = lengths_at_start_[i] + metres_per_count_[i] * static_cast<double>(out_.counts[i]);
    if (dt > 0.0) {
      const double velocity = metres_per_count_[i] * static_cast<double>(moved) / dt;
      out_.velocity_m_per_s[i] += (velocity - out_.velocity_m_per_s[i]) * dt / (tau + dt);
    }
  }
  out_.digital_inputs = feedback.digital_inputs;
}

}  // namespace knee_robot::control
