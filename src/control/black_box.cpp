#include "black_box.h"

#include <algorithm>

namespace knee_robot::control {

BlackBox::BlackBox(const std::string& name)
    : rt::TaskContext(name), inputs_{&command_1, &command_2, &command_3, &command_4} {}

bool BlackBox::configureHook() {
  for (Slot& slot : slots_) {
    if (slot.waits.load(std::memory_order_acquire))
      continue;  // recovered from an exception: what waits is still wanted
    slot.dump.rows.assign(static_cast<std::size_t>(rows.value()), BlackBoxRow{});
    slot.dump.next = slot.dump.count = 0;
  }
  return true;
}

void BlackBox::updateHook(const rt::Cycle& cycle) {
  if (slots_[active_].waits.load(std::memory_order_acquire)) {
    if (slots_[1 - active_].waits.load(std::memory_order_acquire)) {
      status.read(status_);
      if (status_.fault != Fault::None && last_fault_ == Fault::None) lost_.fetch_add(1, std::memory_order_relaxed);
      last_fault_ = status_.fault;
      return;
    }
    active_ = 1 - active_;
    slots_[active_].dump.next = slots_[active_].dump.count = 0;
  }
  BlackBoxDump& dump = slots_[active_].dump;
  fill(dump.rows[dump.next], cycle);
  dump.next = (dump.next + 1) % dump.rows.size();
  dump.count = std::min(dump.count + 1, dump.rows.size());
  watchFault();
}

void BlackBox::fill(BlackBoxRow& row, const rt::Cycle& cycle) {
  measurement.read(measured_);
  set_point.read(set_point_);
  verdict.read(verdict_);
  written.read(written_);
  status.read(status_);
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    inputs_[i]->read(commands_[i]);
    row.reference_m[i] = commands_[i].reference_m;
    row.asked_V[i] = commands_[i].volts;
    row.feedforward_N[i] = commands_[i].feedforward_N;
    row.axis_fault[i] = commands_[i].fault != Fault::None ? commands_[i].fault : verdict_.fault[i];
  }
  row.time_s = rt::toSeconds(measured_.read_at);
  row.lateness_s = rt::toSeconds(cycle.wake - cycle.time);
  row.cycle = cycle.period > 0 ? cycle.time / cycle.period : 0;
  row.position_m = measured_.position_m;
  row.velocity_m_per_s = measured_.velocity_m_per_s;
  row.counts = measured_.counts;
  row.command_V = written_.volts;
  row.force_N = written_.force_N;
  row.heat = verdict_.heat;
  row.path_time_s = set_point_.path_time_s;
  row.time_scale = set_point_.time_scale;
  row.set_point = set_point_.sequence;
  row.phase = set_point_.phase;
  row.state = status_.state;
  row.fault = status_.fault;
  row.level = written_.level;
  row.safe_stop = written_.safe_stop;
  row.read_status = measured_.status;
  row.write_status = written_.status;
  row.digital_inputs = measured_.digital_inputs;
  row.digital_outputs = written_.digital_outputs;
}

void BlackBox::watchFault() noexcept {
  BlackBoxDump& dump = slots_[active_].dump;
  const bool begins = status_.fault != Fault::None && last_fault_ == Fault::None;
  last_fault_ = status_.fault;
  if (begins && !triggered_) {
    triggered_ = true;
    left_ = rows_after;
    dump.fault = status_.fault;
    dump.axis = status_.fault_axis;
    dump.fault_time_s = rt::toSeconds(measured_.read_at);
  } else if (triggered_) {
    --left_;
  }
  if (triggered_ && left_ <= 0) handOver();
}

void BlackBox::handOver() noexcept {
  triggered_ = false;
  slots_[active_].waits.store(true, std::memory_order_release);
}

/// The rows after the fault will not come any more.
void BlackBox::stopHook() {
  if (triggered_) handOver();
}

const BlackBoxDump* BlackBox::findWaiting() const noexcept {
  for (const Slot& slot : slots_) {
    if (slot.waits.load(std::memory_order_acquire)) return &slot.dump;
  }
  return nullptr;
}

void BlackBox::giveBack(const BlackBoxDump* written) noexcept {
  for (Slot& slot : slots_) {
    if (&slot.dump == written) slot.waits.store(false, std::memory_order_release);
  }
}

}  // namespace knee_robot::control
