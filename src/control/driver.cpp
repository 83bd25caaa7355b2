#include "knee_robot/control/driver.h"

#include <algorithm>
#include <cmath>

#include "longest_step.h"

namespace knee_robot::control {
namespace {

/// Cycles without a new feedforward after which it counts as switched off.
constexpr int kSilentFeedforward = 5;
constexpr double kSmallestError_m = 1e-5;
/// Of the force that an encoder was asked with before: a hand guides through most of the friction.
constexpr double kGuidedShare = 0.5;
/// Ten times the following error of a good loop: a healthy axis so far behind its reference moves when it is asked.
constexpr double kLeftBehind_m = 0.001;
/// After the brakes opened: the platform sags a little, and what is asked meanwhile teaches nothing.
constexpr double kSags_s = 0.5;
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
  if (set_point.read(received) == rt::FlowStatus::NewData && active_) raise(follower_.accept(received, cycle.time));
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
  // Beginning or ending in the middle of a motion is switching, too.
  const double step = alive == feedforward_alive_ ? model_force_.switched_N[index_] - switched_ : load - load_;
  if (active_ && step != 0.0) {
    pid_.shiftIntegral(-step);
    shifted_N_ += step;
  }
  switched_ = model_force_.switched_N[index_];
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
  guided_ = guides_ = false;
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
  if (guided_ && !guides_) follower_.takeOver(measured_.position_m[index_], cycle.time);
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
  if (follower_.isStale(cycle.time, stale_set_points)) raise(Fault::SetPointStale);
  if (unreadable_ >= stale_measurements) raise(Fault::MeasurementLost);
  const double error = out_.reference_m - measured_.position_m[index_];
  const double limit = following_floor + following_slope * std::abs(out_.reference_velocity);
  if (!searching && std::abs(error) > limit) raise(Fault::FollowingError);
}

/// At rest the axes take turns; a suspicion is asked of all at once.
double Driver::probeEncoder(double dt) noexcept {
  const double open_s = 2.0 * hardware_.holdDelay() + kOpens_s;
  disturbance.read(disturbed_);
  verdict.read(verdict_);
  out_.can_be_asked = false;
  const bool carries = order_.driversCarry() && order_.homed && order_.homing == 0 && unreadable_ == 0;
  if (!carries || probe_period <= 0.0) {
    carried_s_ = 0.0;
    suspicion_ = disturbed_.suspicion;
    questions_ = disturbed_.questions;
    challenge_.reset();
    probe_.reset();
    return 0.0;
  }
  if (carried_s_ == 0.0) released_.begin(measured_.counts[index_]);
  carried_s_ += dt;
  released_.take(measured_.counts[index_]);
  if (carried_s_ < open_s) return 0.0;  // the holding brakes are still opening
  const bool just_opened = carried_s_ - dt < open_s;
  const bool settled = carried_s_ >= kSags_s;
  if (!settled && !just_opened && !challenge_.isActive()) return 0.0;
  out_.can_be_asked = verdict.isConnected();
  const double first = kSags_s + probe_period * static_cast<double>(index_) / hardware::kAxes;
  const EncoderProbe::Settings settings{first, probe_period, probe_share * force_limit_, disturbance.isConnected()};
  if (challengeEncoder(dt, settings, just_opened)) return challenge_.force_N();
  // A hand is guided by HandGuide's questions: pulses that learn would free the friction that holds what nobody declared.
  if (!settled || (order_.guiding && disturbance.isConnected())) return 0.0;
  if (!test_pulses_.load(std::memory_order_relaxed)) {
    if (!disturbance.isConnected()) probe_.reset();
    return 0.0;
  }
  if (!probe_.step(out_.at_rest, dt, measured_.counts[index_], settings)) raise(deadOrBlocked());
  return probe_.force_N();
}

/// True while it asks, or brings its pulse to an end. An axis whose encoder has not counted while its brake opened is
/// asked at once: blind, it lets the platform sink by a load that nobody declared, and its loop sees nothing of it.
bool Driver::challengeEncoder(double dt, const EncoderProbe::Settings& settings, bool just_opened) noexcept {
  const std::int64_t counts = measured_.counts[index_];
  const bool unseen = just_opened && !released_.counts() && test_pulses_.load(std::memory_order_relaxed);
  const bool disturbed = disturbed_.suspicion != suspicion_;
  const bool suspected = carried_s_ >= kSags_s && standsUnderForce(dt, counts);
  const bool in_turn = disturbed_.questions != questions_ && disturbed_.asked == static_cast<int>(index_) &&
                       test_pulses_.load(std::memory_order_relaxed);
  suspicion_ = disturbed_.suspicion;
  questions_ = disturbed_.questions;
  if ((measured_.bus_failure.silent >> index_ & 1u) !=
      0) {  // old counts are no answer; that they are old has a fault of its own
    challenge_.reset();
    standing_.begin(counts);
    return false;
  }
  const bool wanted =
      unseen || (disturbed && !standing_.counts()) || suspected || in_turn || verdict_.asks[index_] || doubted_;
  if (wanted && !challenge_.isActive()) {
    opening_ = just_opened;
    // A hand has no reference: to and fro in turn, or questions would carry the platform away.
    if (guides_) guided_away_ = -guided_away_;
    const double away =
        guides_ ? guided_away_ : (out_.reference_m - measured_.position_m[index_]) / actuator_.metresPerCount();
    const double enough_N = (guides_ ? kGuidedShare : 1.0) * probe_.enoughForce_N();
    challenge_.begin(counts, {enough_N, probe_.certainForce_N(settings), away, standing_.dithers(),
                              !unseen && !disturbed && out_.at_rest, !out_.at_rest});
  }
  const double lag_m = std::abs(out_.reference_m - measured_.position_m[index_]);
  switch (challenge_.step(dt, counts, out_.at_rest || guides_ || lag_m < kLeftBehind_m)) {
    case EncoderChallenge::Verdict::Alive:
      if (!opening_) probe_.acceptAnswer(counts);  // what is enough it still has to learn
      standing_.endures(asked_at_N_);
      ++out_.answers;
      break;
    case EncoderChallenge::Verdict::Dead:
      raise(deadOrBlocked());
      break;
    case EncoderChallenge::Verdict::None:
      break;
  }
  return challenge_.isActive();
}

/// What no count to all this means.
Fault Driver::deadOrBlocked() const noexcept {
  // At rest the others stick and may feel nothing of an axis that moves.
  return disturbed_.felt[index_] == Felt::No && !out_.at_rest ? Fault::AxisBlocked : Fault::EncoderFrozen;
}

/// A healthy axis that hunts at rest is asked less and less often.
bool Driver::standsUnderForce(double dt, std::int64_t counts) noexcept {
  constexpr double kWhileRecording = 2.0;
  constexpr double kOverdueShare = 0.5;                    // of the force: a soft loop lags without being blind
  constexpr double kBeyondUsual = 1.3, kUsualMost = 0.25;  // of the force limit: friction may not hide a blind axis
  constexpr double kAgain_s = 0.5, kSeldom_s = 4.0, kAgainMoving_s = 0.15, kAgainOverdue_s = 0.03, kTimes = 4.0;
  const bool rests = out_.at_rest;
  standing_.step(dt, counts, out_.reference_m, loopForce() + shifted_N_, challenge_.isActive());
  if (rests != stood_at_rest_) {
    standing_.begin(counts);
    again_s_ = kAgain_s;
  }
  stood_at_rest_ = rests;
  asked_s_ += dt;
  const double usual_N = std::min(kBeyondUsual * standing_.usual_N(), kUsualMost * force_limit_);
  // An axis that turns for the first times sticks, too. Recordings for a model are to have few questions: later then,
  // not never.
  const double patience = test_pulses_.load(std::memory_order_relaxed) ? 1.0 : kWhileRecording;
  const double limit_N = patience * (rests ? standing_force : turning_force), turning_N = std::max(limit_N, usual_N);
  const bool overdue = !rests && standing_.changed_N() >= kOverdueShare * limit_N &&
                       standing_.isOverdue(patience * actuator_.metresPerCount());
  const double again_moving_s = overdue ? kAgainOverdue_s : kAgainMoving_s;
  const double again_s = !rests ? again_moving_s : standing_.changed_N() > kTimes * limit_N ? kAgain_s : again_s_;
  if (!disturbance.isConnected() || asked_s_ < again_s ||
      (!overdue && standing_.changed_N() < (rests ? limit_N : turning_N)))
    return false;
  asked_at_N_ = rests ? 0.0 : standing_.changed_N();
  standing_.begin(counts);
  asked_s_ = 0.0;
  again_s_ = std::min(kSeldom_s, 2.0 * again_s_);
  return true;
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
  const double pulse_N = probeEncoder(dt);
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
