#include "axes_output.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::control {
namespace {
constexpr double kAskAgain_s = 10.0;
constexpr double kFindsMass_s = 0.1;
constexpr double kCreep_m_per_s = 0.001, kCreepCounts = 2.5;  // slower is not told from the encoder's steps
constexpr rt::Nanoseconds kCreepLook = 20'000'000;
constexpr double kShareOfMean = 0.05, kDoubtful = 3.0;  ///< of one cycle: some 20 ms; five standard errors of +-2 mm
constexpr double kStands_m_per_s = 0.005;
/// A load estimate that is wrong by some newtons lets an axis sink more slowly than that.
constexpr double kRuns_m = 0.003, kRuns_m_per_s = 0.15;

Fault faultOfRefusal(hardware::IoStatus refused) noexcept {
  return refused == hardware::IoStatus::FencedOut ? Fault::GuardianActed : Fault::OutputLost;
}

}  // namespace

AxesOutput::AxesOutput(const std::string& name, const mechanism::Robot& robot, const HardwareFile& hardware,
                       hardware::AxisBus& bus)
    : rt::TaskContext(name),
      robot_(robot),
      hardware_(hardware),
      bus_(bus),
      inputs_{&command_1, &command_2, &command_3, &command_4} {}

bool AxesOutput::configureHook() {
  SafeStopTiming timing;
  timing.decelerate_limit = rt::fromSeconds(decelerate_limit);
  timing.settle = rt::fromSeconds(settle_time);
  // Shorted windings let the platform sink, and `none` does not hold at all: there is nothing to watch.
  timing.transfer = hardware_.holdsByBrakes() ? rt::fromSeconds(transfer_time) : 0;
  timing.hold_delay = rt::fromSeconds(hardware_.holdDelay());
  timing.disable_delay = rt::fromSeconds(hardware_.drive_enable_delay_s);
  safe_stop_ = SafeStop(timing);
  return true;
}

bool AxesOutput::startHook() {
  const std::uint32_t completed = out_.safe_stops;
  out_ = AxesWritten{};
  out_.safe_stops = completed;
  safe_stop_.rearm();
  heard_ = false;
  hardware::BrakeWatch watch;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const double count_m = robot_.actuators[i].metresPerCount();
    watch.slip_counts[i] = static_cast<std::int32_t>(slip / count_m) + 1;
    watch.counts_per_mm[i] = 1e-3 / count_m;
  }
  bus_.watchBrakes(watch);
  return true;
}

void AxesOutput::updateHook(const rt::Cycle& cycle) {
  heard_ = orders.read(order_) != rt::FlowStatus::NoData || heard_;
  AxesMeasurement measured;
  measurement.read(measured);
  out_.sequence = measured.sequence;
  out_.time = cycle.time;
  readCommands(cycle);
  heedDrives(measured);
  followOrders(cycle);
  runSafeStop(cycle, measured);
  writeVolts(chooseVolts(), cycle.time);
  writeOutputs(cycle.time);
  estimateLoad(measured, rt::toSeconds(cycle.period));
  offerLoad();
  out_.safe_stop = safe_stop_.phase();
  out_.holds_here = safe_stop_.holdsHere();
  out_.unordered = outputs_refused_;
  out_.transfer = order_.transfer;
  written.write(out_);
}

Fault AxesOutput::checkCommand(const AxisCommand& command, std::size_t axis, const rt::Cycle& cycle) const noexcept {
  const bool on_its_wire = command.axis == static_cast<int>(axis) + 1;
  if (!on_its_wire || cycle.time - command.time > rt::fromSeconds(command_timeout)) return Fault::CommandStale;
  if (!command.active) return command.fault == Fault::None ? Fault::CommandStale : command.fault;
  if (!std::isfinite(command.volts)) return Fault::NotANumber;
  return Fault::None;
}

void AxesOutput::readCommands(const rt::Cycle& cycle) {
  all_closed_ = true;
  watched_ = false;
  verdict.read(verdict_);
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    inputs_[i]->read(commands_[i]);
    Fault fault = checkCommand(commands_[i], i, cycle);
    if (fault == Fault::None && !loopStaysClosed(verdict_.fault[i])) fault = verdict_.fault[i];
    closed_[i] = fault == Fault::None;
    astray_[i] = fault == Fault::Runaway;
    const bool blind = fault == Fault::EncoderJump || fault == Fault::AccelerationLimit;
    begins_[i] = blind && !blind_[i];
    blind_[i] = blind;
    watched_ = watched_ || closed_[i];
    if (closed_[i] || !all_closed_) continue;
    all_closed_ = false;
    open_axis_ = static_cast<int>(i) + 1;
    open_fault_ = fault;
  }
}

/// A drive that has no power or cannot be reached closes no loop, whatever its Driver computes: nothing slows down
/// along the path then.
void AxesOutput::heedDrives(const AxesMeasurement& measured) noexcept {
  const bool ready = out_.level < DriveLevel::HeldByDrivers || !lines_.drivesNotReady(measured);
  const bool carries = safe_stop_.phase() == SafeStopPhase::Carrying;
  power_came_back_ =
      carries && ready && power_was_lost_;  // drives that were without it must not push again by themselves
  power_was_lost_ = carries && (!ready || power_was_lost_);
  const Fault fault = ready ? control::faultOf(measured.bus_failure.fault) : Fault::DrivesNotReady;
  if (fault == Fault::DriveLost) leaveLost(measured.bus_failure);
  if (!ready || (!loopStaysClosed(fault) && measured.bus_failure.axis == 0)) watched_ = false;
  if (!all_closed_ || loopStaysClosed(fault)) return;
  all_closed_ = false;
  open_axis_ = ready ? measured.bus_failure.axis : 0;
  open_fault_ = fault;
}

/// A loop over old counts would push its axis anywhere; the others carry on.
void AxesOutput::leaveLost(const hardware::BusFailure& failure) noexcept {
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    closed_[i] = closed_[i] && (failure.silent >> i & 1u) == 0 && failure.axis != i + 1;
  watched_ = std::any_of(closed_.begin(), closed_.end(), [](bool closed) { return closed; });
}

void AxesOutput::beginSafeStop(Fault fault, int axis, rt::Nanoseconds now) noexcept {
  if (safe_stop_.phase() != SafeStopPhase::Idle || out_.level == DriveLevel::Off) return;
  out_.fault = fault;
  out_.fault_axis = axis;
  safe_stop_.trigger(now, out_.level == DriveLevel::Released);
}

/// Up one level at a time; everything else is the safe stop.
void AxesOutput::followOrders(const rt::Cycle& cycle) {
  const bool ordered_off = heard_ && order_.level == DriveLevel::Off && !order_.safe_stop;
  if (safe_stop_.phase() == SafeStopPhase::Done && ordered_off) {
    safe_stop_.rearm();
    out_.fault = Fault::None;
    out_.fault_axis = 0;
  }
  if (safe_stop_.phase() != SafeStopPhase::Idle) return;
  const bool armed = out_.level != DriveLevel::Off;
  const bool stale = !heard_ || cycle.time - order_.time > rt::fromSeconds(orders_timeout);
  if (armed && stale) return beginSafeStop(Fault::OrdersStale, 0, cycle.time);
  if (armed && (order_.safe_stop || order_.level < out_.level)) return beginSafeStop(Fault::None, 0, cycle.time);
  if (out_.level >= DriveLevel::HeldByDrivers && !all_closed_) {
    return beginSafeStop(open_fault_, open_axis_, cycle.time);
  }
  if (stale || order_.safe_stop || order_.level <= out_.level) return;
  const auto next = static_cast<DriveLevel>(static_cast<int>(out_.level) + 1);
  if (next >= DriveLevel::HeldByDrivers && !all_closed_) return;  // the Drivers have to take over first
  out_.level = next;
  if (next != DriveLevel::HeldByDrivers) return;
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    load_[i].begin(commands_[i]);
}

bool AxesOutput::isAtRest() const noexcept {
  return std::all_of(commands_.begin(), commands_.end(), [](const AxisCommand& command) { return command.at_rest; });
}

void AxesOutput::runSafeStop(const rt::Cycle& cycle, const AxesMeasurement& measured) {
  const HoldView hold{!outputs_refused_, slips(measured),  transferNumber(cycle), creeps(measured, cycle.time),
                      watched_,          stands(measured), runs(measured)};
  safe_stop_.step(cycle.time, all_closed_, isAtRest(), order_.immediate || power_came_back_, hold);
  out_.safe_stops = safe_stop_.completed();
  if (safe_stop_.phase() == SafeStopPhase::Done) out_.level = DriveLevel::Off;
}

/// Asked for by the Supervisor; where there is none any more, nobody else would ever hand over the load again.
std::uint32_t AxesOutput::transferNumber(const rt::Cycle& cycle) noexcept {
  const bool stale = !heard_ || cycle.time - order_.time > rt::fromSeconds(orders_timeout);
  if (safe_stop_.phase() != SafeStopPhase::Carrying || !stale) asked_at_ = cycle.time;
  if (cycle.time - asked_at_ >= rt::fromSeconds(kAskAgain_s)) {
    asked_at_ = cycle.time;
    ++own_transfers_;
  }
  return order_.transfer + own_transfers_;
}

/// While the load is handed over no axis may move. An encoder that goes to and fro is no brake that slips: where it is
/// the fault its mean counts.
bool AxesOutput::slips(const AxesMeasurement& measured) noexcept {
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const bool averages = blind_[i] && !begins_[i] && std::isfinite(mean_m_[i]);  // no number must not stay for ever
    const double position_m = measured.position_m[i];
    mean_m_[i] = averages ? mean_m_[i] + kShareOfMean * (position_m - mean_m_[i]) : position_m;
  }
  if (!safe_stop_.isTransferring()) {
    transfer_m_ = mean_m_;
    return false;
  }
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    if (std::abs(mean_m_[i] - transfer_m_[i]) <= (blind_[i] ? kDoubtful : 1.0) * slip) continue;
    out_.fault = Fault::HoldDeviceSlips;
    out_.fault_axis = static_cast<int>(i) + 1;
    return true;
  }
  return false;
}

/// Behind brakes that engaged in motion.
bool AxesOutput::stands(const AxesMeasurement& measured) const noexcept {
  return std::all_of(measured.velocity_m_per_s.begin(), measured.velocity_m_per_s.end(),
                     [](double velocity) { return std::abs(velocity) < kStands_m_per_s; });
}

/// A drive that nothing can be told any more pushes harder than its brake holds.
bool AxesOutput::runs(const AxesMeasurement& measured) noexcept {
  const SafeStopPhase phase = safe_stop_.phase();
  const bool braked =
      safe_stop_.holdsHere() || phase == SafeStopPhase::Transferring || phase == SafeStopPhase::Carrying;
  if (!braked) braked_m_ = measured.position_m;
  for (std::size_t i = 0; braked && i < hardware::kAxes; ++i) {
    const bool far = std::abs(measured.position_m[i] - braked_m_[i]) > kRuns_m;
    if (far && !closed_[i] && std::abs(measured.velocity_m_per_s[i]) > kRuns_m_per_s) return true;
  }
  return false;
}

/// A brake that gives way slowly has not moved by `slip` yet when the transfer is over; it is watched for longer then.
bool AxesOutput::creeps(const AxesMeasurement& measured, rt::Nanoseconds now) noexcept {
  const bool let_go = safe_stop_.isTransferring() && safe_stop_.share() == 0.0;
  if (let_go && now - creep_at_ < kCreepLook) return creeps_;
  creeps_ = false;
  for (std::size_t i = 0; let_go && i < hardware::kAxes; ++i) {
    const double least =
        std::max(kCreep_m_per_s * rt::toSeconds(kCreepLook), kCreepCounts * robot_.actuators[i].metresPerCount());
    creeps_ = creeps_ || std::abs(measured.position_m[i] - creep_m_[i]) >= least;
  }
  creep_m_ = measured.position_m;
  creep_at_ = now;
  return creeps_;
}

void AxesOutput::testBrakes(AxisValues& volts) const noexcept {
  if (out_.level != DriveLevel::Energised || safe_stop_.phase() != SafeStopPhase::Idle) return;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    volts[i] = clamped(voltsOf(order_.brake_test_N[i], i), i);
  }
}

double AxesOutput::voltsOf(double force_N, std::size_t axis) const noexcept {
  const mechanism::Actuator& actuator = robot_.actuators[axis];
  return actuator.force_sign * force_N / actuator.force_per_volt_N;
}

double AxesOutput::clamped(double volts, std::size_t axis) const noexcept {
  const mechanism::Actuator& actuator = robot_.actuators[axis];
  double limit = actuator.voltage_max_V;
  if (actuator.force_max_N > 0.0) limit = std::min(limit, actuator.force_max_N / actuator.force_per_volt_N);
  return std::clamp(volts, -limit, limit);
}

AxisValues AxesOutput::chooseVolts() const noexcept {
  AxisValues volts{};
  if (out_.level < DriveLevel::HeldByDrivers) {
    testBrakes(volts);
    return volts;
  }
  // No brake holds, and the axis has no loop: what it carried at rest is the best that is left, where it had the right
  // sign.
  const bool braked =
      safe_stop_.holdsHere() || safe_stop_.phase() == SafeStopPhase::Carrying || safe_stop_.isTransferring();
  const bool unheld = braked || (outputs_refused_ && safe_stop_.engagesHold());
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const double load = voltsOf(unheld ? load_[i].atRest_N() : load_[i].lately_N(), i);
    const double without_loop = braked && astray_[i] ? 0.0 : load;
    volts[i] = clamped(safe_stop_.share() * (closed_[i] ? commands_[i].volts : without_loop), i);
  }
  return volts;
}

void AxesOutput::writeVolts(const AxisValues& volts, rt::Nanoseconds now) {
  out_.status = bus_.writeVolts(volts, out_.volts);
  if (out_.status != hardware::IoStatus::Ok) beginSafeStop(faultOfRefusal(out_.status), 0, now);
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const mechanism::Actuator& actuator = robot_.actuators[i];
    out_.force_N[i] = actuator.force_sign * actuator.force_per_volt_N * out_.volts[i];
  }
}

void AxesOutput::writeOutputs(rt::Nanoseconds now) {
  heartbeat_ = !heartbeat_;
  const bool enable = out_.level >= DriveLevel::Energised && !safe_stop_.disablesDrive();
  const bool release = out_.level == DriveLevel::Released && !safe_stop_.engagesHold();
  unsigned bits = heartbeat_ ? 1u << hardware_.heartbeat_bit : 0u;
  if (enable) bits |= 1u << hardware_.drive_enable_bit;
  if (release) bits |= 1u << hardware_.hold_release_bit;
  out_.digital_outputs = static_cast<std::uint8_t>(bits);
  const hardware::IoStatus status = bus_.writeOutputs(out_.digital_outputs);
  const bool refused =
      status != hardware::IoStatus::Ok && status != hardware::IoStatus::FencedOut && !bus_.stopsByItself();
  if (refused && !outputs_refused_) lost_at_rest_ = isAtRest();
  outputs_refused_ = refused;
  if (status == hardware::IoStatus::Ok) return;
  out_.status = status;
  beginSafeStop(faultOfRefusal(status), 0, now);
}

/// Also while a safe stop settles or carries.
void AxesOutput::estimateLoad(const AxesMeasurement& measured, double dt) noexcept {
  const bool idle = safe_stop_.phase() == SafeStopPhase::Idle;
  const bool stands = safe_stop_.phase() == SafeStopPhase::Settling || safe_stop_.phase() == SafeStopPhase::Carrying;
  released_s_ = out_.level == DriveLevel::Released ? released_s_ + dt : 0.0;
  const bool learns = released_s_ > hardware_.holdDelay() && (idle || stands);
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    if (!closed_[i]) continue;
    load_[i].follow(commands_[i]);
    if (learns) load_[i].learn(commands_[i], out_.force_N[i], measured.position_m[i], dt);
  }
  if (!learns || !all_closed_ || !isAtRest()) return;
  const auto isPushed = [](const CarriedLoad& load) { return load.isPushed(); };
  if (std::any_of(load_.begin(), load_.end(), isPushed))
    std::for_each(load_.begin(), load_.end(), [](CarriedLoad& load) { load.learnAnew(); });
  findMass(dt);
}

/// What nobody foresaw and the axes share as a mass on the platform does goes with the place as its weight does.
void AxesOutput::findMass(double dt) noexcept {
  double shared = 0.0, all = 0.0;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    shared += commands_[i].per_kg_N * load_[i].beside_N();
    all += commands_[i].per_kg_N * commands_[i].per_kg_N;
  }
  if (!(all > 0.0)) return;
  const double kg = shared / all * dt / (kFindsMass_s + dt);
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    load_[i].addMass(kg, commands_[i].per_kg_N);
}

/// For the guardian, should this process die now: until the brakes hold, the platform would fall without. During a safe
/// stop, too, as long as the drives have power; but not where no brake can be ordered any more since the platform moved
/// and nothing is known of its weight there: it would be pushed on blindly.
void AxesOutput::offerLoad() noexcept {
  const bool carries = out_.level == DriveLevel::Released && !safe_stop_.disablesDrive();
  const bool known = lost_at_rest_ ||
                     std::all_of(load_.begin(), load_.end(), [](const CarriedLoad& load) { return load.isWeighed(); });
  if (!carries || (outputs_refused_ && !known)) return bus_.offerLoad(nullptr);
  AxisValues load{};
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    load[i] = clamped(voltsOf(load_[i].atRest_N(), i), i);
  bus_.offerLoad(&load);
}

void AxesOutput::stopHook() {
  if (out_.level != DriveLevel::Off) {
    safe_stop_.finishAtOnce();
    out_.safe_stops = safe_stop_.completed();
    out_.level = DriveLevel::Off;
  }
  out_.digital_outputs = 0;
  bus_.writeOutputs(0);
  bus_.writeVolts(AxisValues{}, out_.volts);
  out_.force_N = AxisValues{};
  out_.safe_stop = safe_stop_.phase();
  written.write(out_);
}

}  // namespace knee_robot::control
