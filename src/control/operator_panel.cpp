#include "operator_panel.h"

namespace knee_robot::control {

OperatorPanel::OperatorPanel(const MachineComponents& machine) : rt::TaskContext("Operator") {
  rt::connect(request_, machine.supervisor->request, rt::ConnPolicy::buffer(16));
  rt::connect(machine.supervisor->status, status_);
  rt::connect(machine.monitors->verdict, verdict_);
  rt::connect(machine.output->written, written_);
  rt::connect(machine.recorder->row, row_);
  if (machine.observer != nullptr) rt::connect(machine.observer->disturbance, disturbance_);
}

std::optional<std::uint32_t> OperatorPanel::send(RequestKind kind, double value, rt::Nanoseconds expires) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::optional<std::uint32_t> number = numbers_.take();
  if (!number) return std::nullopt;
  Request asked;
  asked.number = *number;
  asked.kind = kind;
  asked.value = value;
  asked.expires = expires;
  if (request_.write(asked)) return number;
  numbers_.giveBack(*number);
  return std::nullopt;
}

void OperatorPanel::forget(std::uint32_t number) {
  const std::lock_guard<std::mutex> lock(mutex_);
  numbers_.giveBack(number);
}

template <typename T>
std::optional<T> OperatorPanel::newest(rt::InputPort<T>& port) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  T value;
  if (port.read(value) == rt::FlowStatus::NoData) return std::nullopt;
  return value;
}

SupervisorStatus OperatorPanel::supervisor() const {
  return newest(status_).value_or(SupervisorStatus{});
}

std::optional<TrackingRow> OperatorPanel::row() const {
  return newest(row_);
}

std::optional<MonitorVerdict> OperatorPanel::verdict() const {
  return newest(verdict_);
}

std::optional<AxesWritten> OperatorPanel::written() const {
  return newest(written_);
}

std::optional<Disturbance> OperatorPanel::disturbance() const {
  return newest(disturbance_);
}

}  // namespace knee_robot::control
