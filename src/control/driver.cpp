#include "knee_robot/control/driver.h"

#include <algorithm>
#include <cmath>

#include "longest_step.h"

namespace knee_robot::control {
namespace {

/// Cycles without a new feedforward after which it counts as switched off.
constexpr int kSilentFeedforward = 5;
constexpr double kSmallestError_m = 1e-5;
constexpr double kOpens_s = 0.02;  // beyond twice the slowest brake's delay

}  // namespace

Driver::Driver(const std::string& name, const mechanism::Robot& robot, const HardwareFile& hardware)
    : rt::TaskContext(name), robot_(robot), hardware_(hardware) {}

bool Driver::configureHook() {
  index_ = static_cast<std::size_t>(axis.value()) - 1;
  if (index_ >= robot_.actuators.size()) return refuse("the robot file has no actuator for this axis");
  actuator_ = robot_.actuators[index_];
  force_limit_ = actuator_.forceLimit();
  follower_ = SetPointFollower(static_cast<int>(index_), actuator_.position_min_m, actuator_.position_max_m,
                               actuator_.velocity_max_m_per_s, missing_set_points);
  pid_.setGains(gains());
  return true;
}

PidGains Driver::gains() const noexcept {
  if (model_closes_) return {0.0, integral, 0.0, derivative_cutoff};
  return {proportional, integral, derivative, derivative_cutoff};
}

/// No step of force when P and D give way to the model's feedback, or take over again.
void Driver::changeLoop(const PidInput& input) noexcept {
  pid_.changeGains(gains(), input);
  if (model_closes_ == model_closed_) return;
  pid_.shiftIntegral(model_closes_ ? -loop_ : last_loop_);
  model_closed_ = model_closes_;
}

/// What the loop gives beyond the feedforward, without the derivative term.
double Driver::loopForce() const noexcept {
  const double error = out_.reference_m - measured_.position_m[index_];
  return pid_.integral() + (model_closes_ ? loop_ : proportional * error);
}

bool Driver::startHook() {
  active_ = false;
  fault_ = Fault::None;
  unreadable_ = 0;
  homing_ = HomingMove{};
  out_ = AxisCommand{};
  out_.axis = axis;
  return true;
}

void Driver::raise(Fault fault) noexcept {
  if (fault_ == Fault::None || (loopStaysClosed(fault_) && !loopStaysClosed(fault))) fault_ = fault;
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
  out_.feedforward_N = 0.0;
  if (active_) {
    control(cycle);
  } else {
    out_.reference_m = measured_.position_m[index_];
    out_.reference_velocity = 0.0;
    out_.at_rest = true;
    out_.homing = HomingPhase::Idle;
  }
  last_time_ = cycle.time;
  out_.homed = order_.homed;
  out_.sequence = measured_.sequence;
  out_.time = cycle.time;
  out_.active = active_;
  out_.loaded = !feedforward.isConnected() || model_force_.complete;
  out_.fault = fault_;
  command.write(out_);
}

void Driver::readPorts(const rt::Cycle& cycle) {
  orders.read(order_);
  const bool fresh = measurement.read(measured_) == rt::FlowStatus::NewData;
  unreadable_ = fresh && measured_.status == hardware::IoStatus::Ok ? 0 : unreadable_ + 1;
  SetPoint received;
  const bool follows = active_ && !order_.holds_here;
  if (set_point.read(received) == rt::FlowStatus::NewData && follows) raise(follower_.accept(received, cycle.time));
  readFeedforward(cycle);
  readGuidance(cycle);
}

void Driver::readGuidance(const rt::Cycle& cycle) noexcept {
  const std::uint32_t before = guide_.suspicion;
  const bool heard = guidance.read(guide_) != rt::FlowStatus::NoData;
  const bool alive = heard && order_.guiding && cycle.time - guide_.time <= kSilentFeedforward * cycle.period;
  guides_ = alive && guide_.active && active_;
  guided_N_ = alive ? guide_.force_N[index_] : 0.0;
  doubted_ = guides_ && guide_.suspicion != before && guide_.doubted[index_];
}

void Driver::readFeedforward(const rt::Cycle& cycle) noexcept {
  const bool heard = feedforward.read(model_force_) != rt::FlowStatus::NoData;
  const bool alive = heard && cycle.time - model_force_.time <= kSilentFeedforward * cycle.period;
  const double load = alive ? model_force_.force_N[index_] : 0.0;
  const double weight = alive ? model_force_.weight_N[index_] : 0.0;
  // Beginning or ending in the middle of a motion is switching, too.
  const bool goes_on = alive == feedforward_alive_;
  const double step = goes_on ? model_force_.switched_N[index_] - switched_ : load - load_;
  if (active_ && step != 0.0) {
    pid_.shiftIntegral(-step);
    shifted_N_ += step;
  }
  out_.declared_N += goes_on ? model_force_.declared_N[index_] - declared_ : weight - out_.weight_N;
  out_.weight_N = weight;
  out_.per_kg_N = alive ? model_force_.per_kg_N[index_] : 0.0;
  switched_ = model_force_.switched_N[index_];
  declared_ = model_force_.declared_N[index_];
  load_ = load;
  feedforward_alive_ = alive;
  last_loop_ = loop_;
  loop_ = alive ? model_force_.loop_N[index_] : 0.0;
  model_closes_ = alive && model_force_.closes_loop;
}

void Driver::takeOver(const rt::Cycle& cycle) {
  if (unreadable_ != 0) return;
  const double position = measured_.position_m[index_];
  follower_.takeOver(position, cycle.time);
  pid_.reset(position);
  model_closed_ = model_closes_;
  pid_.setGains(gains());
  guided_ = guides_ = held_here_ = false;
  carried_N_ = 0.0;
  homing_ = HomingMove{};
  last_time_ = cycle.time;
  active_ = true;
}

/// Homing begins where the axis stands and is over for good until the Drivers are switched off: nothing is played in
/// between.
SetPointFollower::Reference Driver::chooseReference(const rt::Cycle& cycle, double dt) noexcept {
  force_now_ = force_limit_;
  if (homing_.phase() == HomingPhase::Idle && isToHome()) {
    const bool on_switch = hardware_.homing.method == HomingMethod::Switch;
    homing_.begin(hardware_.homing.axes[index_], on_switch, measured_.position_m[index_]);
    carried_N_ = pid_.takeIntegral();
  }
  const bool stays = order_.holds_here && !held_here_;  // where the brakes hold, or should
  held_here_ = order_.holds_here;
  if ((guided_ && !guides_) || stays) follower_.takeOver(measured_.position_m[index_], cycle.time);
  if (guides_) return {measured_.position_m[index_], 0.0, false};
  if (homing_.phase() == HomingPhase::Idle) return follower_.at(cycle.time);
  if (!isToHome()) homing_.abandon();
  const bool switch_on =
      hardware_.homing.switch_bit && (measured_.digital_inputs >> *hardware_.homing.switch_bit & 1) != 0;
  const HomingMove::Output move =
      homing_.step(measured_.position_m[index_], measured_.velocity_m_per_s[index_], switch_on, dt, force_limit_);
  force_now_ = move.force_limit_N;
  return {move.reference_m, move.velocity, move.velocity == 0.0};
}

void Driver::checkReference(const rt::Cycle& cycle, bool searching) {
  if (!order_.holds_here && follower_.isStale(cycle.time, stale_set_points)) raise(Fault::SetPointStale);
  if (unreadable_ >= stale_measurements) raise(Fault::MeasurementLost);
  const double error = out_.reference_m - measured_.position_m[index_];
  const double limit = following_floor + following_slope * std::abs(out_.reference_velocity);
  if (!searching && std::abs(error) > limit) raise(Fault::FollowingError);
}

/// The force of the encoder's test.
double Driver::watchEncoder(double dt) noexcept {
  disturbance.read(disturbed_);
  verdict.read(verdict_);
  EncoderWatch::Settings settings;
  settings.index = index_;
  settings.metres_per_count = actuator_.metresPerCount();
  settings.force_limit_N = force_limit_;
  settings.open_s = 2.0 * hardware_.holdDelay() + kOpens_s;
  settings.probe_s = probe_period;
  settings.probe_share = probe_share;
  settings.standing_force_N = standing_force;
  settings.turning_force_N = turning_force;
  settings.observed = disturbance.isConnected();
  settings.monitored = verdict.isConnected();
  EncoderWatch::Input in;
  in.dt = dt;
  in.carries = order_.driversCarry() && (order_.homed || order_.seeks_home) && unreadable_ == 0;
  in.counts = measured_.counts[index_];
  in.silent = (measured_.bus_failure.silent >> index_ & 1u) != 0;
  in.position_m = measured_.position_m[index_];
  in.reference_m = out_.reference_m;
  in.at_rest = out_.at_rest;
  in.loop_N = loopForce() + shifted_N_;
  in.searches = homing_.phase() == HomingPhase::Searching;
  in.guiding = order_.guiding;
  in.guides = guides_;
  in.doubted = doubted_;
  in.monitor_asks = verdict_.asks[index_];
  in.test_pulses = test_pulses_.load(std::memory_order_relaxed);
  const EncoderWatch::Output watched = encoder_.step(in, disturbed_, settings);
  out_.can_be_asked = watched.can_be_asked;
  if (watched.answered) ++out_.answers;
  if (watched.fault != Fault::None) raise(watched.fault);
  return watched.force_N;
}

/// The force of loop, feedforward and guidance. Into guiding the integral takes along what the loop carried; out of it
/// the loop begins where the axis is, with its velocity to brake.
double Driver::loop(const SetPointFollower::Reference& reference, double dt) noexcept {
  PidInput input;
  input.reference = reference.position;
  input.reference_velocity = reference.velocity;
  input.measured = measured_.position_m[index_];
  input.feedforward = load_ + loop_ + guided_N_;
  input.dt = dt;
  if (guides_) {
    if (!guided_) {
      input.reference = follower_.at(last_time_).position;
      pid_.changeGains({0.0, integral, 0.0, derivative_cutoff}, input);
    }
    guided_ = true;
    return std::clamp(pid_.follow(input), -force_now_, force_now_);
  }
  if (guided_) pid_.setGains(gains());
  guided_ = false;
  changeLoop(input);
  // At rest an error that the encoder hardly resolves is no reason to hunt; a blind axis would wander off by it.
  input.integral_dead_band = reference.at_rest ? std::max(actuator_.metresPerCount(), kSmallestError_m) : 0.0;
  return pid_.update(input, force_now_);
}

void Driver::control(const rt::Cycle& cycle) {
  const double dt = std::min(rt::toSeconds(cycle.time - last_time_), kLongestStep_s);
  const SetPointFollower::Reference reference = chooseReference(cycle, dt);
  out_.reference_m = reference.position;
  out_.reference_velocity = reference.velocity;
  out_.at_rest = reference.at_rest;
  out_.homing = homing_.phase();
  out_.home_m = homing_.found_m();
  checkReference(cycle, homing_.phase() == HomingPhase::Searching);

  const double loop_N = loop(reference, dt);
  const double pulse_N = watchEncoder(dt);
  const double asked = loop_N + carried_N_ + pulse_N;
  out_.pulse_N = pulse_N;
  const double force = std::clamp(asked, -force_limit_, force_limit_);
  if (!std::isfinite(force)) raise(Fault::NotANumber);
  if (!loopStaysClosed(fault_)) {
    active_ = false;
    out_.at_rest = true;
    return;
  }
  out_.force_N = force;
  out_.feedforward_N = load_;
  out_.moving_N = feedforward_alive_ ? model_force_.moving_N[index_] : 0.0;
  out_.volts = actuator_.force_sign * force / actuator_.force_per_volt_N;
}

}  // namespace knee_robot::control
