#include "monitors.h"

#include <algorithm>

namespace knee_robot::control {
namespace {

/// Longer than filters need to settle, and than a pose needs to be found again.
constexpr double kLongestUnjudged_s = 1.0;
/// An observer that runs behind the monitors, or a cycle without it, is no reason to stop.
constexpr std::uint64_t kJudgedBefore = 2;  // measurements

}  // namespace

Monitors::Monitors(const std::string& name, const mechanism::Robot& robot)
    : rt::TaskContext(name),
      robot_(robot),
      inputs_{&command_1, &command_2, &command_3, &command_4},
      patient_monitor_(robot) {
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    axes_[i].force_limit_N = robot_.actuators.at(i).forceLimit();
}

void Monitors::setPatient(const PatientRange& range) {
  const std::lock_guard<std::mutex> lock(offering_);
  offered_.write(range);
}

bool Monitors::startHook() {
  any_ = false;
  if (out_.sequence == 0) {
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      axes_[i].thermal.start(std::max<double>(thermal_start, known_heat_[i]));
  }
  forget();
  return true;
}

void Monitors::forget() noexcept {
  for (Axis& axis : axes_)
    axis.reset();
  out_.asks.fill(false);
  patient_monitor_.reset();
  too_strong_.reset();
  unjudged_.reset();
  carried_s_ = 0.0;
}

void Monitors::readPorts() {
  measurement.read(measured_);
  written.read(written_);
  offered_.read(patient_);
  disturbance.read(disturbed_);
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    inputs_[i]->read(commands_[i]);
}

void Monitors::raise(std::size_t axis, Fault fault) noexcept {
  if (out_.fault[axis] == Fault::None || (loopStaysClosed(out_.fault[axis]) && !loopStaysClosed(fault)))
    out_.fault[axis] = fault;
}

void Monitors::updateHook(const rt::Cycle& cycle) {
  readPorts();
  const bool powered = written_.level >= DriveLevel::HeldByDrivers;
  if (!powered) out_.fault.fill(Fault::None);
  carried_ = written_.level == DriveLevel::Released &&
             (written_.safe_stop == SafeStopPhase::Idle || slowsDown(written_.safe_stop));
  if (!carried_) forget();
  out_.time = cycle.time;
  const bool new_reading = measured_.status == hardware::IoStatus::Ok && measured_.sequence != out_.sequence;
  out_.sequence = measured_.sequence;
  gap_ = gap_ || measured_.status != hardware::IoStatus::Ok;
  if (new_reading) {
    const double dt = any_ ? rt::toSeconds(measured_.read_at - last_read_) : 0.0;
    if (carried_) carried_s_ += dt;
    monitorAxes(dt);
    raise(0, monitorPatient(dt));
    raise(0, monitorForce(dt));
    last_read_ = measured_.read_at;
    any_ = true;
    gap_ = false;
  }
  verdict.write(out_);
}

/// An axis that is driven blindly moves the platform, and others run away with it: the cause is the one that does not
/// count.
void Monitors::monitorAxes(double dt) noexcept {
  std::array<Fault, hardware::kAxes> found{};
  std::array<bool, hardware::kAxes> blind{};
  bool runs = false;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const AxisView view = viewOf(i, dt);
    found[i] = evaluate(i, view);
    blind[i] = axes_[i].frozen.seesNothing(view.reference_m, frozen_distance);
    runs = runs || found[i] == Fault::Runaway;
  }
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    raise(i, runs && blind[i] && found[i] != Fault::Runaway ? Fault::EncoderFrozen : found[i]);
}

AxisView Monitors::viewOf(std::size_t i, double dt) noexcept {
  const mechanism::Actuator& actuator = robot_.actuators[i];
  Axis& axis = axes_[i];
  AxisView view;
  view.dt = dt;
  view.after_gap = gap_;
  view.moved_m = any_ ? actuator.encoder_sign * actuator.metresPerCount() *
                            static_cast<double>(measured_.counts[i] - axis.last_counts)
                      : 0.0;
  axis.last_counts = measured_.counts[i];
  view.position_m = measured_.position_m[i];
  view.velocity = measured_.velocity_m_per_s[i];
  view.reference_m = commands_[i].reference_m;
  view.reference_velocity = commands_[i].reference_velocity;
  view.force_N = written_.force_N[i];
  view.force_limit_N = axis.force_limit_N;
  view.can_be_asked = commands_[i].can_be_asked;
  view.answers = commands_[i].answers;
  return view;
}

/// Those after which the loop must not go on come first.
Fault Monitors::evaluate(std::size_t i, const AxisView& view) noexcept {
  const mechanism::Actuator& actuator = robot_.actuators[i];
  Axis& axis = axes_[i];
  const bool hot = axis.thermal.step(view, actuator.force_continuous_N, thermal_time, thermal_share, thermal_housing);
  out_.heat[i] = axis.thermal.heat();
  const bool leaps = axis.leap.step(view, actuator.metresPerCount(), jump_factor, jump_acceleration);
  if (any_ && (leaps || axis.jump.step(view, actuator.velocity_max_m_per_s, jump_factor, jump_floor, jump_gap)))
    return Fault::EncoderJump;
  if (axis.noise.step(view, actuator.metresPerCount())) return Fault::EncoderJump;
  const Fault heat = hot ? Fault::ThermalOverload : Fault::None;  // stays for minutes, and must hide nothing of these
  if (!carried_) return heat;
  const bool searching =
      commands_[i].homing == HomingPhase::Searching;  // there, standing against a stop is what is wanted
  const bool taking_over = takingOver();
  if (searching || taking_over) axis.frozen.reset();
  const double stuck_N = std::min<double>(frozen_share * view.force_limit_N, frozen_force);
  const auto frozen = searching || taking_over ? EncoderFrozenMonitor::Verdict::Counts
                                               : axis.frozen.step(view, frozen_distance, stuck_N);
  out_.asks[i] = frozen == EncoderFrozenMonitor::Verdict::Ask;
  if (frozen == EncoderFrozenMonitor::Verdict::Dead) return Fault::EncoderFrozen;
  const double far = taking_over ? std::max<double>(runaway_error, release_error) : runaway_error;
  if (axis.runaway.step(view, far, runaway_speed, runaway_acceleration, runaway_share, runaway_time))
    return Fault::Runaway;
  if (axis.acceleration.step(view, acceleration_factor * actuator.acceleration_max_m_per_s2)) {
    return axis.runaway.suspects() ? Fault::Runaway : Fault::AccelerationLimit;
  }
  if (axis.velocity.step(view, actuator.velocity_max_m_per_s, velocity_factor, velocity_floor, velocity_time)) {
    return Fault::VelocityLimit;
  }
  if (hot) return heat;
  if (commands_[i].homed &&
      axis.soft.step(view, actuator.position_min_m, actuator.position_max_m, soft_margin, soft_speed)) {
    return Fault::SoftLimit;
  }
  if (searching) return Fault::None;
  if (axis.saturation.step(view, saturation_time)) return Fault::Saturated;
  if (axis.stall.step(view, stall_share, stall_speed, stall_error, stall_time)) return Fault::Stalled;
  if (axis.stall.time_s() > 0.5 * stall_time) out_.asks[i] = true;  // a blind axis seems to stand, too
  const AxisCommand& command = commands_[i];
  const bool stands = command.homed && command.at_rest && !taking_over;
  return axis.weight.step(view, command.feedforward_N - command.moving_N, stands) ? Fault::WeightOpposite : Fault::None;
}

/// Only what a model explains can be told from a force on the patient; a limit that nobody can judge protects nobody.
Fault Monitors::monitorForce(double dt) noexcept {
  const bool limited = carried_ && patient_.given && patient_.limitsForce() && !takingOver();
  const bool judged = disturbed_.identified && disturbed_.known;
  // The newest judgement counts until there is another one: an observer may be slower than the monitors.
  const bool too_strong = limited && judged && !patient_.allowsForce(disturbed_.wrench);
  if (too_strong_.step(too_strong, dt, patient_force_time)) return Fault::PatientForce;
  const bool current = measured_.sequence - disturbed_.sequence <= kJudgedBefore;
  return unjudged_.step(limited && !(judged && current), dt, kLongestUnjudged_s) ? Fault::MonitorsStale : Fault::None;
}

Fault Monitors::monitorPatient(double dt) noexcept {
  if (!carried_ || !any_ || !commands_[0].homed) return Fault::None;
  const PatientMonitor::Verdict verdict = patient_monitor_.step(patient_, measured_.position_m, dt, patient_margin_m,
                                                                patient_margin_rad, patient_speed_factor);
  if (takingOver()) patient_monitor_.forgetSpeed();  // the sag; seen in a window, it would count for longer
  switch (verdict) {
    case PatientMonitor::Verdict::Fine:
      return Fault::None;
    case PatientMonitor::Verdict::Pose:
      return Fault::PatientPose;
    case PatientMonitor::Verdict::Speed:
      return takingOver() ? Fault::None : Fault::PatientSpeed;
  }
  return Fault::None;
}

}  // namespace knee_robot::control
