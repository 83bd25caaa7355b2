#include "recorder.h"

namespace knee_robot::control {

Recorder::Recorder(const std::string& name)
    : rt::TaskContext(name), inputs_{&command_1, &command_2, &command_3, &command_4} {}

void Recorder::updateHook(const rt::Cycle& cycle) {
  measurement.read(measured_);
  set_point.read(set_point_);
  written.read(written_);
  disturbance.read(disturbance_);
  out_.test_pulse = 0;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    inputs_[i]->read(commands_[i]);
    out_.reference_m[i] = commands_[i].reference_m;
    out_.feedforward_N[i] = commands_[i].feedforward_N;
    if (commands_[i].pulse_N != 0.0) out_.test_pulse |= static_cast<std::uint8_t>(1u << i);
  }
  out_.sequence = measured_.sequence;
  out_.home_number = measured_.home_number;
  out_.recording = recording_.load(std::memory_order_acquire);
  out_.cycle = cycle.period > 0 ? cycle.time / cycle.period : 0;
  out_.time_s = rt::toSeconds(measured_.read_at);
  out_.position_m = measured_.position_m;
  out_.velocity_m_per_s = measured_.velocity_m_per_s;
  out_.command_V = written_.volts;
  out_.force_N = written_.force_N;
  out_.residual_known = disturbance_.identified && disturbance_.known;
  out_.residual_N = disturbance_.residual_N;
  out_.path_time_s = set_point_.path_time_s;
  out_.digital_inputs = measured_.digital_inputs;
  out_.digital_outputs = written_.digital_outputs;
  row.write(out_);
  if (out_.recording == 0 || measured_.status != hardware::IoStatus::Ok) return;
  if (measured_.sequence == recorded_)
    return;  // AxesInput does not run: a second row of the same moment would say nothing
  recorded_ = measured_.sequence;
  if (!ring_.write(out_)) dropped_.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace knee_robot::control
