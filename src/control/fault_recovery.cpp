#include "fault_recovery.h"

namespace knee_robot::control {
namespace {

constexpr double kAnswer_s = 1.0;
constexpr double kRecovery_s = 0.05;  // components and drives that are taken out of a fault

/// Back to Running by whatever way is left. False for what only a restart mends.
bool revive(rt::TaskContext& component) {
  if (component.state() == rt::TaskState::Exception || component.state() == rt::TaskState::RunTimeError)
    component.recover();
  if (component.state() == rt::TaskState::PreOperational) component.configure();
  if (component.state() == rt::TaskState::Stopped) component.start();
  return component.state() == rt::TaskState::Running;
}

}  // namespace

Answer FaultRecovery::reset() {
  const MachineState before = report_.state();
  if (before == MachineState::Disabled) return {true, "there is no fault to reset"};
  if (before != MachineState::Faulted)
    return {false, std::string("not possible while the robot is ") + toString(before)};
  if (bus_.isFencedOut() && bus_.reclaim() != hardware::IoStatus::Ok) {
    return {false, "the guardian does not give the outputs back; look whether it runs, then restart the controller"};
  }
  for (const auto& component : deployment_.components()) {
    if (!revive(*component)) return {false, component->name() + " cannot be recovered: " + component->refusal()};
  }
  bus_.acknowledgeFaults();
  // A few cycles, so that what is answered is about the recovered components.
  runner_.waitUntil([] { return false; }, kRecovery_s);
  // A safe stop that still runs; or the latched fault.
  const auto rests = [this] {
    const MachineState now = report_.state();
    return now == MachineState::Disabled || now == MachineState::Faulted;
  };
  runner_.waitUntil(rests, kSafeStop_s);
  if (report_.state() == MachineState::Disabled) return {true, "the components were recovered; the robot is disabled"};
  return requests_.make(RequestKind::Reset, kAnswer_s);
}

}  // namespace knee_robot::control
