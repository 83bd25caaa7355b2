#include "knee_robot/control/supervisor.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::control {
namespace {

bool isPowered(MachineState state) noexcept {
  return state != MachineState::Disabled && state != MachineState::Faulted;
}

}  // namespace

Supervisor::Supervisor(const std::string& name, const mechanism::Robot& robot, const HardwareFile& hardware)
    : rt::TaskContext(name),
      robot_(robot),
      hardware_(hardware),
      inputs_{&command_1, &command_2, &command_3, &command_4} {}

bool Supervisor::startHook() {
  const std::array<RequestAnswer, SupervisorStatus::kAnswers> answers = status_.answers;
  const std::array<bool, hardware::kAxes> homed = status_.homed;
  const std::uint32_t play = orders_.play;  // a play number is never used twice
  const std::uint32_t transfer = orders_.transfer;
  status_ = SupervisorStatus{};
  status_.answers = answers;
  status_.homed = homed;
  if (hardware_.homing.method == HomingMethod::Assumed && !started_before_) status_.homed.fill(true);
  if (hardware_.starts_faulted && !started_before_) {
    status_.fault = Fault::NotReset;
    status_.state = MachineState::Faulted;
  }
  started_before_ = true;
  homing_ = home_found_ = false;
  unjudged_ = 0;
  orders_ = SupervisorCommand{};
  orders_.play = play;
  orders_.transfer = transfer;
  pending_ = 0;
  unreadable_ = 0;
  written.read(written_);
  if (!drivesAreOff()) {
    // Started anew while AxesOutput is still bringing the machine to rest: the Drivers hold until it is done.
    status_.state = MachineState::SafeStopping;
    orders_.level = written_.level;
  }
  return true;
}

void Supervisor::updateHook(const rt::Cycle& cycle) {
  readPorts();
  lookForFaults();
  Request asked;
  while (request.read(asked) == rt::FlowStatus::NewData)
    handle(asked, cycle.time);
  advance(cycle.time);
  publish(cycle.time);
}

void Supervisor::readPorts() {
  const bool fresh = measurement.read(measured_) == rt::FlowStatus::NewData;
  unreadable_ = fresh && measured_.status == hardware::IoStatus::Ok ? 0 : unreadable_ + 1;
  set_point.read(set_point_);
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    inputs_[i]->read(commands_[i]);
  written.read(written_);
  const bool judged = verdict.read(verdict_) == rt::FlowStatus::NewData && verdict_.sequence == measured_.sequence;
  unjudged_ = judged ? 0 : unjudged_ + 1;
  readGuide();
}

bool Supervisor::isHomed() const noexcept {
  return std::all_of(status_.homed.begin(), status_.homed.end(), [](bool one) { return one; });
}

bool Supervisor::drivesAreOff() const noexcept {
  return written_.level == DriveLevel::Off;
}

/// Refusals, waiting and answers: see control_system.h.
void Supervisor::answer(std::uint32_t number, RequestResult result, int axis, double distance) noexcept {
  status_.answers[number % SupervisorStatus::kAnswers] = {number, result, axis, distance};
}

void Supervisor::settlePending(RequestResult result) noexcept {
  if (pending_ != 0) answer(pending_, result);
  pending_ = 0;
}

void Supervisor::handle(const Request& asked, rt::Nanoseconds now) {
  if (!isPossible(status_.state, asked.kind)) return answer(asked.number, RequestResult::WrongState);
  switch (asked.kind) {
    case RequestKind::Enable:
      homing_ = false;
      return enable(asked, now);
    case RequestKind::Disable:
      settlePending(RequestResult::Superseded);
      if (written_.safe_stop == SafeStopPhase::Carrying) ++orders_.transfer;
      if (status_.state == MachineState::Disabled) return answer(asked.number, RequestResult::Done);
      status_.state = MachineState::SafeStopping;
      pending_ = asked.number;
      return;
    case RequestKind::Play:
      settlePending(RequestResult::Superseded);
      if (!isReady()) return answer(asked.number, RequestResult::NotReady);
      ++orders_.play;
      orders_.pause_path = false;
      pending_ = asked.number;
      return;
    case RequestKind::Stop:
      // A play request that Sync has not taken yet is stopped, too.
      if (status_.state == MachineState::Playing || status_.state == MachineState::Paused ||
          (status_.state == MachineState::Holding && pending_ != 0)) {
        status_.state = MachineState::Stopping;
      }
      if (status_.state == MachineState::Guiding) status_.state = MachineState::Holding;
      if (status_.state == MachineState::Homing) status_.state = MachineState::SafeStopping;
      settlePending(RequestResult::Superseded);
      return answer(asked.number, RequestResult::Done);
    case RequestKind::EmergencyStop:
      raise(Fault::EmergencyStop, 0);
      return answer(asked.number, RequestResult::Done);
    case RequestKind::Reset:
      return reset(asked);
    case RequestKind::Pause:
    case RequestKind::Resume:
      orders_.pause_path = asked.kind == RequestKind::Pause;
      return answer(asked.number, RequestResult::Done);
    case RequestKind::SetSpeed:
      if (!(asked.value >= 0.0 && asked.value <= 1.0)) return answer(asked.number, RequestResult::OutOfRange);
      orders_.speed = asked.value;
      return answer(asked.number, RequestResult::Done);
    case RequestKind::Home:
    case RequestKind::ConfirmHome:
      return home(asked, now);
    case RequestKind::Guide:
      return guide(asked);
  }
}

bool Supervisor::isReady() const noexcept {
  const auto runs = [](const rt::TaskContext* one) { return one->state() == rt::TaskState::Running; };
  return unreadable_ == 0 && written_.status == hardware::IoStatus::Ok &&
         std::all_of(watched_.begin(), watched_.end(), runs);
}

void Supervisor::enable(const Request& asked, rt::Nanoseconds now) {
  settlePending(RequestResult::Superseded);
  const bool output_is_idle = drivesAreOff() && written_.safe_stop == SafeStopPhase::Idle;
  if (!isReady() || !output_is_idle) return answer(asked.number, RequestResult::NotReady);
  if (!isHomed() && !homing_) return answer(asked.number, RequestResult::NotHomed);
  status_.state = MachineState::Enabling;
  switch_was_released_ = false;
  orders_.level = DriveLevel::Energised;
  enabling_since_ = step_since_ = now;
  pending_ = asked.number;
}

void Supervisor::reset(const Request& asked) {
  const ResetRule rule = describe(status_.fault).reset;
  if (rule == ResetRule::Restart) return answer(asked.number, RequestResult::NeedsRestart);
  if (rule == ResetRule::WhenCauseIsGone && causeRemains()) return answer(asked.number, RequestResult::CauseRemains);
  status_.fault = Fault::None;
  status_.fault_axis = 0;
  status_.fault_component = -1;
  status_.state = MachineState::Disabled;
  answer(asked.number, RequestResult::Done);
}

void Supervisor::advance(rt::Nanoseconds now) {
  switch (status_.state) {
    case MachineState::Enabling:
      return advanceEnabling(now);
    case MachineState::Holding:
    case MachineState::Playing:
    case MachineState::Stopping:
    case MachineState::Paused:
      return advancePlaying();
    case MachineState::Homing:
      return advanceHoming(now);
    case MachineState::Guiding:
      return advanceGuiding();
    case MachineState::SafeStopping:
      return advanceSafeStop();
    case MachineState::Disabled:
    case MachineState::Faulted:
      return;
  }
}

/// Energised -> (drive delay) -> HeldByDrivers -> (loops closed, feedforward complete, for settle_s) -> Released -> (hold delay) -> Holding.
void Supervisor::advanceEnabling(rt::Nanoseconds now) {
  if (now - enabling_since_ > rt::fromSeconds(enable_limit)) return raise(Fault::EnableTimeout, 0);
  const auto carries = [](const AxisCommand& command) { return command.active && command.loaded; };
  const bool all_carry = std::all_of(commands_.begin(), commands_.end(), carries);
  if (written_.level != orders_.level) step_since_ = now;
  const double elapsed = rt::toSeconds(now - step_since_);
  switch (written_.level) {
    case DriveLevel::Off:
      return;
    case DriveLevel::Energised:
      if (elapsed < hardware_.drive_enable_delay_s) {
        brake_test_m_ = measured_.position_m;
      } else if (testBrakes(now)) {
        orders_.level = DriveLevel::HeldByDrivers;
      }
      return;
    case DriveLevel::HeldByDrivers:
      if (!all_carry) step_since_ = now;
      if (elapsed >= settle_time) orders_.level = DriveLevel::Released;
      return;
    case DriveLevel::Released:
      if (elapsed < hardware_.holdDelay()) return;
      status_.state = homing_ ? MachineState::Homing : MachineState::Holding;
      step_since_ = now;
      settlePending(RequestResult::Done);
      return;
  }
}

/// One axis after the other, shortening first, then lengthening: the force rises for kRise, stays, and is gone. True: all hold.
bool Supervisor::testBrakes(rt::Nanoseconds now) {
  constexpr double kRise_s = 0.02, kStep_s = 0.05;
  orders_.brake_test_N = AxisValues{};
  if (brake_test <= 0.0) return true;
  const double time = rt::toSeconds(now - step_since_) - hardware_.drive_enable_delay_s;
  const int step = static_cast<int>(time / kStep_s);
  const auto axis = static_cast<std::size_t>(step / 2);
  if (axis >= hardware::kAxes) return true;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const bool holds = std::abs(measured_.position_m[i] - brake_test_m_[i]) <= brake_slip;
    if (holds || hardware_.axes[i].hold_device != HoldDevice::Brake) continue;
    raise(Fault::HoldDeviceSlips, static_cast<int>(i) + 1);
    return false;
  }
  if (hardware_.axes[axis].hold_device != HoldDevice::Brake) return false;
  const double rise = std::min(1.0, (time - step * kStep_s) / kRise_s);
  orders_.brake_test_N[axis] = (step % 2 == 0 ? -rise : rise) * brake_test;
  return false;
}

void Supervisor::advancePlaying() {
  const bool taken = orders_.play != 0 && set_point_.run == orders_.play;
  const bool refused = orders_.play != 0 && set_point_.refused_run == orders_.play;
  if (refused) {
    answerRefusedPlay();
    status_.state = MachineState::Holding;
  }
  if (refused || !taken || set_point_.phase == SyncPhase::Idle) return;
  const bool stop_asked = status_.state == MachineState::Stopping;
  switch (set_point_.phase) {
    case SyncPhase::Holding:
      status_.state = MachineState::Holding;
      return settlePending(RequestResult::Done);
    case SyncPhase::Stopping:
      // Nobody asked for it: Sync stopped by itself. Never report that as the end of the path.
      if (!stop_asked && status_.state != MachineState::Holding) raise(Fault::OrdersStale, 0);
      return;
    case SyncPhase::Playing:
    case SyncPhase::Paused:
      if (stop_asked) return;  // Sync has not heard of it yet
      status_.state = set_point_.phase == SyncPhase::Paused ? MachineState::Paused : MachineState::Playing;
      return settlePending(RequestResult::Done);
    case SyncPhase::Idle:
      return;
  }
}

void Supervisor::answerRefusedPlay() noexcept {
  if (pending_ == 0) return;
  const RequestResult result = set_point_.refusal == PlayRefusal::NoReference  ? RequestResult::NoReference
                               : set_point_.refusal == PlayRefusal::NotAtStart ? RequestResult::NotAtStart
                                                                               : RequestResult::NotReady;
  answer(pending_, result, set_point_.refused_axis, set_point_.refused_distance_m);
  pending_ = 0;
}

void Supervisor::advanceSafeStop() {
  if (written_.safe_stop == SafeStopPhase::Carrying && written_.transfer == orders_.transfer)
    settlePending(RequestResult::Failed);
  const bool output_runs = output_ == nullptr || output_->state() == rt::TaskState::Running;
  const bool off = drivesAreOff() && (written_.safe_stop == SafeStopPhase::Done ||
                                      (written_.safe_stop == SafeStopPhase::Idle && orders_.safe_stop));
  if (output_runs && !off) return;
  status_.state = status_.fault == Fault::None ? MachineState::Disabled : MachineState::Faulted;
  endHoming();
  settlePending(status_.fault == Fault::None ? RequestResult::Done : RequestResult::Failed);
}

void Supervisor::publish(rt::Nanoseconds now) {
  const bool powered = isPowered(status_.state);
  orders_.safe_stop = status_.state == MachineState::SafeStopping;
  orders_.stop_path = status_.state == MachineState::Stopping || orders_.safe_stop;
  if (!powered) orders_.level = DriveLevel::Off;
  if (status_.state != MachineState::Enabling) orders_.brake_test_N = AxisValues{};
  orders_.homed = isHomed();
  orders_.homing = 0;
  if (status_.state == MachineState::Homing) orders_.homing = homingBit();
  orders_.guiding = status_.state == MachineState::Guiding;
  orders_.drivers_active = powered && orders_.level >= DriveLevel::HeldByDrivers;
  orders_.immediate = emergencyInput() || measured_.fenced_out;
  ++orders_.sequence;
  orders_.time = now;
  orders.write(orders_);
  status_.time = now;
  status_.path_time_s = set_point_.path_time_s;
  status_.path_duration_s = set_point_.path_duration_s;
  status_.time_scale = set_point_.time_scale;
  status_.speed = orders_.speed;
  status_.safe_stops = written_.safe_stops;
  status.write(status_);
}

}  // namespace knee_robot::control
