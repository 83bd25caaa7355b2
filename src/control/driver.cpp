#include "knee_robot/control/driver.h"

#include <algorithm>
#include <cmath>

namespace knee_robot {
namespace {

/// After a pause of the machine the integral must not jump.
constexpr double kLongestStep_s = 0.005;

}  // namespace

Driver::Driver(const std::string& name, const Robot& robot) : TaskContext(name), robot_(robot) {}

bool Driver::configureHook() {
  index_ = static_cast<std::size_t>(axis.value()) - 1;
  if (index_ >= robot_.actuators.size()) return refuse("the robot file has no actuator for this axis");
  actuator_ = robot_.actuators[index_];
  force_limit_ = actuator_.voltage_max_V * actuator_.force_per_volt_N;
  if (actuator_.force_max_N > 0.0) force_limit_ = std::min(force_limit_, actuator_.force_max_N);
  follower_ = SetPointFollower(static_cast<int>(index_), actuator_.position_min_m, actuator_.position_max_m,
                               actuator_.velocity_max_m_per_s);
  pid_.setGains(gains());
  return true;
}

PidGains Driver::gains() const noexcept {
  return {proportional, integral, derivative, derivative_cutoff};
}

bool Driver::startHook() {
  active_ = false;
  fault_ = Fault::None;
  unreadable_ = 0;
  out_ = AxisCommand{};
  out_.axis = axis;
  return true;
}

void Driver::raise(Fault fault) noexcept {
  if (fault_ == Fault::None || (closesLoop(fault_) && !closesLoop(fault))) fault_ = fault;
}

void Driver::updateHook(const rt::Cycle& cycle) {
  readPorts(cycle);
  if (!order_.drivers_active) {
    active_ = false;
    fault_ = Fault::None;
  } else if (!active_ && fault_ == Fault::None) {
    takeOver(cycle);
  }
  out_.volts = 0.0;
  out_.force_N = 0.0;
  if (active_) {
    control(cycle);
  } else {
    out_.reference_m = measured_.position_m[index_];
    out_.reference_velocity = 0.0;
    out_.at_rest = true;
  }
  last_time_ = cycle.time;
  out_.sequence = measured_.sequence;
  out_.time = cycle.time;
  out_.active = active_;
  out_.fault = fault_;
  command.write(out_);
}

void Driver::readPorts(const rt::Cycle& cycle) {
  orders.read(order_);
  feedforward.read(load_);
  const bool fresh = measurement.read(measured_) == rt::FlowStatus::NewData;
  unreadable_ = fresh && measured_.status == hardware::IoStatus::Ok ? 0 : unreadable_ + 1;
  SetPoint received;
  if (set_point.read(received) == rt::FlowStatus::NewData && active_) raise(follower_.accept(received, cycle.time));
}

void Driver::takeOver(const rt::Cycle& cycle) {
  if (unreadable_ != 0) return;
  const double position = measured_.position_m[index_];
  follower_.takeOver(position, cycle.time);
  pid_.reset(position);
  last_time_ = cycle.time;
  active_ = true;
}

void Driver::checkReference(const rt::Cycle& cycle) {
  if (follower_.isStale(cycle.time, stale_set_points)) raise(Fault::SetPointStale);
  if (unreadable_ >= stale_measurements) raise(Fault::MeasurementLost);
  const double error = out_.reference_m - measured_.position_m[index_];
  const double limit = following_floor + following_slope * std::abs(out_.reference_velocity);
  if (std::abs(error) > limit) raise(Fault::FollowingError);
}

void Driver::control(const rt::Cycle& cycle) {
  const SetPointFollower::Reference reference = follower_.at(cycle.time);
  out_.reference_m = reference.position;
  out_.reference_velocity = reference.velocity;
  out_.at_rest = reference.at_rest;
  checkReference(cycle);

  PidInput input;
  input.reference = reference.position;
  input.reference_velocity = reference.velocity;
  input.measured = measured_.position_m[index_];
  input.feedforward = load_;
  input.dt = std::min(rt::toSeconds(cycle.time - last_time_), kLongestStep_s);
  pid_.changeGains(gains(), input);
  const double force = pid_.update(input, force_limit_);
  if (!std::isfinite(force)) raise(Fault::NotANumber);
  if (!closesLoop(fault_)) {
    active_ = false;
    out_.at_rest = true;
    return;
  }
  out_.force_N = force;
  out_.volts = actuator_.force_sign * force / actuator_.force_per_volt_N;
}

}  // namespace knee_robot
