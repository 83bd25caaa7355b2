#include "supervisor.h"

#include <cmath>

namespace knee_robot::control {
namespace {

constexpr double kPause_s = 0.01;     ///< of the servo cycle; a shorter one is jitter
constexpr double kAftermath_s = 0.5;  ///< what goes wrong later than this after a pause is not its consequence
/// While home is confirmed. One count of 20 um looks like 6 mm/s behind the velocity's low-pass.
constexpr double kStands_m_per_s = 0.02;

bool isPowered(MachineState state) noexcept {
  return state != MachineState::Disabled && state != MachineState::Faulted;
}

RequestResult resultOf(PlayRefusal refusal) noexcept {
  switch (refusal) {
    case PlayRefusal::NoReference:
      return RequestResult::NoReference;
    case PlayRefusal::NotAtStart:
      return RequestResult::NotAtStart;
    case PlayRefusal::None:
    case PlayRefusal::NotReady:
      return RequestResult::NotReady;
  }
  return RequestResult::NotReady;
}

}  // namespace

Supervisor::Supervisor(const std::string& name, const mechanism::Robot& robot, const HardwareFile& hardware)
    : rt::TaskContext(name),
      robot_(robot),
      hardware_(hardware),
      drivers_{&command_1, &command_2, &command_3, &command_4},
      inputs_(hardware_),
      search_(robot_, inputs_, components_),
      held_place_(robot_, hardware_),
      enabling_(hardware_),
      homing_(robot_, hardware_),
      guiding_(inputs_) {}

bool Supervisor::startHook() {
  const std::uint32_t play = orders_.play;  // a play number is never used twice
  const std::uint32_t transfer = orders_.transfer;
  const double speed = orders_.speed;  // whoever has slowed it down goes on being obeyed
  orders_ = SupervisorCommand{};
  orders_.speed = speed;
  orders_.play = play;
  orders_.transfer = transfer;
  answers_.dropPending();
  // Of what was asked of the Supervisor that failed, nothing is done by the one that is started anew.
  for (Request old; request.read(old) == rt::FlowStatus::NewData;)
    answers_.answer(old.number, RequestResult::Failed);
  fault_.clear();
  state_ = MachineState::Disabled;
  if (hardware_.starts_faulted && !started_before_) {
    fault_.latch({Fault::NotReset});
    state_ = MachineState::Faulted;
  }
  homing_.start(!started_before_);
  guiding_.start();
  pause_ = Pause{};
  last_cycle_ = 0;
  started_before_ = true;
  view_.unmonitored = view_.unreadable = 0;
  written.read(view_.written);
  if (!view_.drivesAreOff()) {
    // Started anew while AxesOutput is still bringing the machine to rest: the Drivers hold until it is done.
    state_ = MachineState::SafeStopping;
    orders_.level = view_.written.level;
  }
  return true;
}

void Supervisor::updateHook(const rt::Cycle& cycle) {
  readPorts();
  noticePause(cycle);
  detectFaults(cycle.time);
  Request asked;
  while (request.read(asked) == rt::FlowStatus::NewData)
    handle(asked, cycle);
  advance(cycle.time);
  publish(cycle.time);
}

void Supervisor::readPorts() {
  const bool fresh = measurement.read(view_.measured) == rt::FlowStatus::NewData;
  view_.unreadable = fresh && view_.measured.status == hardware::IoStatus::Ok ? 0 : view_.unreadable + 1;
  set_point.read(view_.set_point);
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    drivers_[i]->read(view_.commands[i]);
  written.read(view_.written);
  const bool monitored =
      verdict.read(view_.verdict) == rt::FlowStatus::NewData && view_.verdict.sequence == view_.measured.sequence;
  view_.unmonitored = monitored ? 0 : view_.unmonitored + 1;
  view_.unguided = guidance.read(view_.guidance) == rt::FlowStatus::NewData ? 0 : view_.unguided + 1;
  guiding_.readSwitch(view_);
}

void Supervisor::noticePause(const rt::Cycle& cycle) noexcept {
  const double since_last_s = rt::toSeconds(cycle.time - last_cycle_);
  if (last_cycle_ != 0 && since_last_s > kPause_s) pause_ = {since_last_s, cycle.time};
  if (rt::toSeconds(cycle.time - pause_.end) > kAftermath_s) pause_ = Pause{};
  last_cycle_ = cycle.time;
}

void Supervisor::detectFaults(rt::Nanoseconds now) {
  FaultSearch::Conditions conditions;
  conditions.range_margin_m = range_margin;
  conditions.stale_cycles = stale_measurements;
  conditions.homed = orders_.homed;
  conditions.disabled = state_ == MachineState::Disabled;
  conditions.overrun = overrun_.exchange(false, std::memory_order_relaxed);
  raise(search_.inSafeStop(view_));
  raise(search_.find(view_, conditions));
  // Not before the axes are homed: until then the robot is placed by hand. What has just cost them their home is no such time.
  const bool off = (state_ == MachineState::Disabled || state_ == MachineState::Faulted) && view_.drivesAreOff();
  const Fault latched = fault_.cause().fault;
  const bool known = homing_.isHomed() || latched == Fault::EncoderFrozen || latched == Fault::AxisBlocked;
  const bool held = off && known && view_.hasMeasured() && !view_.measured.guardian_carries;
  if (const int moved = held_place_.step(held, view_, now); moved != 0) raise({Fault::MovedWhileOff, moved});
  const LostCounts::Axes lost = lost_counts_.step(view_, fault_.isLatched(), now);
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    if (lost[i]) homing_.forget(i);
  }
}

/// The first fault is latched; drives that are on are brought to rest by the safe stop first.
void Supervisor::raise(FaultCause cause) noexcept {
  if (cause.fault != Fault::EmergencyStop && cause.fault != Fault::HandSwitch) cause.paused_s = pause_.length_s;
  if (!fault_.latch(cause)) return;
  if (state_ == MachineState::SafeStopping) return;  // that was asked for; it now ends in Faulted
  answers_.settle(RequestResult::Failed);
  const bool off = view_.drivesAreOff() && orders_.level == DriveLevel::Off;
  state_ = off ? MachineState::Faulted : MachineState::SafeStopping;
}

bool Supervisor::isReady() const noexcept {
  return view_.unreadable == 0 && view_.written.status == hardware::IoStatus::Ok && components_.allRun();
}

void Supervisor::handle(const Request& asked, const rt::Cycle& cycle) {
  const rt::Nanoseconds now = cycle.time;
  // Really now: after a pause of the whole process whoever asked before it has been told that there is no answer.
  const bool slows_down = asked.kind == RequestKind::SetSpeed && asked.value <= orders_.speed;  // 0 pauses
  if (cycle.wake > asked.expires && !onlyStops(asked.kind) && !slows_down)
    return answers_.answer(asked.number, RequestResult::TooLate);
  if (!isPossible(state_, asked.kind)) return answers_.answer(asked.number, RequestResult::WrongState);
  switch (asked.kind) {
    case RequestKind::Enable:
      homing_.prepare(false);
      return enable(asked, now);
    case RequestKind::Disable:
      return disable(asked);
    case RequestKind::Play:
      return play(asked);
    case RequestKind::Stop:
      return stop(asked);
    case RequestKind::EmergencyStop:
      raise({Fault::EmergencyStop});
      return answers_.answer(asked.number, RequestResult::Done);
    case RequestKind::Reset:
      return reset(asked);
    case RequestKind::Pause:
    case RequestKind::Resume:
      orders_.pause_path = asked.kind == RequestKind::Pause;
      return answers_.answer(asked.number, RequestResult::Done);
    case RequestKind::SetSpeed:
      if (!(asked.value >= 0.0 && asked.value <= 1.0)) return answers_.answer(asked.number, RequestResult::OutOfRange);
      orders_.speed = asked.value;
      return answers_.answer(asked.number, RequestResult::Done);
    case RequestKind::Home:
    case RequestKind::ConfirmHome:
      return home(asked, now);
    case RequestKind::Guide:
      return guide(asked);
  }
}

void Supervisor::enable(const Request& asked, rt::Nanoseconds now) {
  answers_.settle(RequestResult::Superseded);
  if (const bool idle = view_.drivesAreOff() && view_.written.safe_stop == SafeStopPhase::Idle; !isReady() || !idle) {
    homing_.prepare(false);
    return answers_.answer(asked.number, RequestResult::NotReady);
  }
  if (!homing_.isHomed() && !homing_.isPrepared()) return answers_.answer(asked.number, RequestResult::NotHomed);
  state_ = MachineState::Enabling;
  guiding_.driversEnabled();
  enabling_.begin(now);
  orders_.level = DriveLevel::Energised;
  answers_.await(asked.number);
}

void Supervisor::disable(const Request& asked) noexcept {
  if (state_ != MachineState::SafeStopping) answers_.settle(RequestResult::Superseded);
  if (view_.written.safe_stop == SafeStopPhase::Carrying) ++orders_.transfer;
  if (state_ == MachineState::Disabled) return answers_.answer(asked.number, RequestResult::Done);
  state_ = MachineState::SafeStopping;
  answers_.await(asked.number);
}

void Supervisor::play(const Request& asked) noexcept {
  answers_.settle(RequestResult::Superseded);
  if (!isReady()) return answers_.answer(asked.number, RequestResult::NotReady);
  ++orders_.play;
  orders_.pause_path = false;
  answers_.await(asked.number);
}

void Supervisor::stop(const Request& asked) noexcept {
  // A play request that Sync has not taken yet is stopped, too.
  const bool about_to_play = state_ == MachineState::Holding && answers_.isAwaiting();
  if (state_ == MachineState::Playing || state_ == MachineState::Paused || about_to_play)
    state_ = MachineState::Stopping;
  if (state_ == MachineState::Guiding) state_ = MachineState::Holding;
  // A caller waiting for the safe stop gets more than a stop; its request is not superseded.
  if (state_ != MachineState::SafeStopping) answers_.settle(RequestResult::Superseded);
  if (state_ == MachineState::Homing) state_ = MachineState::SafeStopping;
  answers_.answer(asked.number, RequestResult::Done);
}

void Supervisor::reset(const Request& asked) noexcept {
  const Fault latched = fault_.cause().fault;
  const ResetRule rule = describe(latched).reset;
  if (rule == ResetRule::Restart) return answers_.answer(asked.number, RequestResult::NeedsRestart);
  if (rule == ResetRule::WhenCauseIsGone && search_.causeRemains(latched, view_))
    return answers_.answer(asked.number, RequestResult::CauseRemains);
  fault_.clear();
  state_ = MachineState::Disabled;
  answers_.answer(asked.number, RequestResult::Done);
}

/// Home: the procedure of the hardware file. ConfirmHome: the operator has put the robot at its home lengths.
void Supervisor::home(const Request& asked, rt::Nanoseconds now) {
  const bool confirms = asked.kind == RequestKind::ConfirmHome;
  if (homing_.isPlacedByHand() != confirms) return answers_.answer(asked.number, RequestResult::NoProcedure);
  if (!isReady()) return answers_.answer(asked.number, RequestResult::NotReady);
  if (homing_.moves()) {
    homing_.prepare(true);
    return enable(asked, now);
  }
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const bool stands = std::abs(view_.measured.velocity_m_per_s[i]) <= kStands_m_per_s;
    if (!stands) return answers_.answer(asked.number, RequestResult::HomeMoves, static_cast<int>(i) + 1);
  }
  const HomingSequence::Taken taken = homing_.takeForHome(view_.measured.position_m);
  if (taken.shifts) home_setting.write(homing_.setting());
  answers_.answer(asked.number, taken.result, taken.axis, taken.distance_m);
}

void Supervisor::guide(const Request& asked) noexcept {
  answers_.settle(RequestResult::Superseded);
  GuidingPermission::Conditions conditions;
  conditions.has_guide = guidance.isConnected();
  conditions.brakes_tested = brake_test > 0.0 && enabling_.brakes().coversAllAxes();
  conditions.ready = isReady();
  const RequestResult result = guiding_.begin(view_, conditions);
  if (result == RequestResult::Done) state_ = MachineState::Guiding;
  answers_.answer(asked.number, result);
}

void Supervisor::advance(rt::Nanoseconds now) {
  switch (state_) {
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
      if (!guiding_.goesOn(view_)) state_ = MachineState::Holding;
      return;
    case MachineState::SafeStopping:
      return advanceSafeStop();
    case MachineState::Disabled:
    case MachineState::Faulted:
      return;
  }
}

void Supervisor::advanceEnabling(rt::Nanoseconds now) {
  const EnablingSequence::Settings settings{enable_limit, settle_time, brake_test, brake_slip};
  const EnablingSequence::Step step = enabling_.step(view_, settings, now);
  orders_.level = step.level;
  orders_.brake_test_N = step.brake_test_N;
  if (step.fault.fault != Fault::None) return raise(step.fault);
  if (!step.done) return;
  state_ = homing_.isPrepared() ? MachineState::Homing : MachineState::Holding;
  homing_.begin(now);
  answers_.settle(RequestResult::Done);
}

void Supervisor::advancePlaying() {
  const SetPoint& sync = view_.set_point;
  const bool taken = orders_.play != 0 && sync.run == orders_.play;
  const bool refused = orders_.play != 0 && sync.refused_run == orders_.play;
  if (refused) {
    answers_.settle(resultOf(sync.refusal), sync.refused_axis, sync.refused_distance_m);
    state_ = MachineState::Holding;
  }
  if (refused || !taken || sync.phase == SyncPhase::Idle) return;
  const bool stop_asked = state_ == MachineState::Stopping;
  switch (sync.phase) {
    case SyncPhase::Holding:
      state_ = MachineState::Holding;
      return answers_.settle(RequestResult::Done);
    case SyncPhase::Stopping:
      // Nobody asked for it: Sync stopped by itself. Never report that as the end of the path.
      if (!stop_asked && state_ != MachineState::Holding) raise({Fault::OrdersStale});
      return;
    case SyncPhase::Playing:
    case SyncPhase::Paused:
      if (stop_asked) return;  // Sync has not heard of it yet
      state_ = sync.phase == SyncPhase::Paused ? MachineState::Paused : MachineState::Playing;
      return answers_.settle(RequestResult::Done);
    case SyncPhase::Idle:
      return;
  }
}

/// Then the safe stop, and only with the drives off the lengths are shifted.
void Supervisor::advanceHoming(rt::Nanoseconds now) {
  switch (homing_.step(view_, now)) {
    case HomingSequence::Progress::Running:
      return;
    case HomingSequence::Progress::Failed:
      return raise({Fault::HomingFailed, homing_.failedAxis()});
    case HomingSequence::Progress::Found:
      state_ = MachineState::SafeStopping;
      return;
  }
}

void Supervisor::advanceSafeStop() {
  const AxesWritten& output = view_.written;
  if (output.safe_stop == SafeStopPhase::Carrying && output.transfer == orders_.transfer)
    answers_.settle(RequestResult::Failed);
  const bool output_runs = output_ == nullptr || output_->state() == rt::TaskState::Running;
  const bool off = view_.drivesAreOff() && (output.safe_stop == SafeStopPhase::Done ||
                                            (output.safe_stop == SafeStopPhase::Idle && orders_.safe_stop));
  if (output_runs && !off) return;
  state_ = fault_.isLatched() ? MachineState::Faulted : MachineState::Disabled;
  if (homing_.end(fault_.isLatched())) home_setting.write(homing_.setting());
  answers_.settle(fault_.isLatched() ? RequestResult::Failed : RequestResult::Done);
}

void Supervisor::publish(rt::Nanoseconds now) {
  publishOrders(now);
  publishStatus(now);
}

void Supervisor::publishOrders(rt::Nanoseconds now) {
  const bool powered = isPowered(state_);
  orders_.safe_stop = state_ == MachineState::SafeStopping;
  const AxesWritten& output = view_.written;
  const bool answers_count = view_.measured.bus_failure.fault == hardware::BusFault::None;
  orders_.slows_down = orders_.safe_stop && output.level == DriveLevel::Released && answers_count &&
                       (output.safe_stop == SafeStopPhase::Idle || slowsDown(output.safe_stop));
  orders_.stop_path = state_ == MachineState::Stopping || orders_.safe_stop;
  orders_.holds_here = orders_.safe_stop && output.holds_here;
  if (!powered) orders_.level = DriveLevel::Off;
  if (state_ != MachineState::Enabling) orders_.brake_test_N = AxisValues{};
  orders_.homed = homing_.isHomed() && !homing_.isPrepared();  // a search shows how much the old lengths were worth
  orders_.seeks_home = state_ == MachineState::Homing;
  orders_.homing = state_ == MachineState::Homing ? homing_.searching() : 0;
  orders_.guiding = state_ == MachineState::Guiding;
  orders_.drivers_active = powered && orders_.level >= DriveLevel::HeldByDrivers;
  orders_.immediate = takesTheMachine(search_.machineTaken(view_));
  ++orders_.sequence;
  orders_.time = now;
  orders.write(orders_);
}

void Supervisor::publishStatus(rt::Nanoseconds now) {
  SupervisorStatus said;
  said.time = now;
  said.state = state_;
  said.fault = fault_.cause().fault;
  said.fault_axis = fault_.cause().axis;
  said.fault_component = fault_.cause().component;
  said.fault_code = fault_.cause().code;
  said.fault_paused_s = fault_.cause().paused_s;
  said.answers = answers_.all();
  said.path_time_s = view_.set_point.path_time_s;
  said.path_duration_s = view_.set_point.path_duration_s;
  said.time_scale = view_.set_point.time_scale;
  said.speed = orders_.speed;
  said.pause_path = orders_.pause_path;
  said.homed = homing_.homed();
  said.safe_stops = view_.written.safe_stops;
  said.guide_stop = guiding_.stop();
  status.write(said);
}

}  // namespace knee_robot::control
