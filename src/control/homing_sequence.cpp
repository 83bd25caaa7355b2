#include "homing_sequence.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::control {
namespace {

constexpr double kQuiet_m = 0.0002;
constexpr double kLargestShift_m = 0.005;
constexpr rt::Nanoseconds kQuiet = 500'000'000;

}  // namespace

HomingSequence::HomingSequence(const mechanism::Robot& robot, const HardwareFile& hardware) : homing_(hardware.homing) {
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    home_lengths_m_[i] = robot.actuators[i].home_length_m;
}

bool HomingSequence::isHomed() const noexcept {
  return std::all_of(homed_.begin(), homed_.end(), [](bool one) { return one; });
}

void HomingSequence::start(bool first) noexcept {
  if (first && homing_.method == HomingMethod::Assumed) homed_.fill(true);
  prepared_ = found_ = false;
}

HomingSequence::Taken HomingSequence::takeForHome(const AxisValues& measured_m) noexcept {
  if (!isPlacedByHand() && isHomed()) return {};
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const double away = std::abs(shifted_m_[i] + home_lengths_m_[i] - measured_m[i]);
    if (homed_[i] && !(away <= kLargestShift_m)) return {RequestResult::HomeShifted, static_cast<int>(i) + 1, away};
  }
  shift(home_lengths_m_, measured_m);
  return {RequestResult::Done, 0, 0.0, true};
}

/// From the next cycle on, what is `measured` now counts as `lengths`.
void HomingSequence::shift(const AxisValues& lengths_m, const AxisValues& measured_m) noexcept {
  ++setting_.number;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    setting_.shift_m[i] = lengths_m[i] - measured_m[i];
    shifted_m_[i] = homed_[i] ? shifted_m_[i] + setting_.shift_m[i] : 0.0;
  }
  homed_.fill(true);
}

void HomingSequence::prepare(bool search) noexcept {
  prepared_ = search;
  if (!search) return;
  step_ = 0;
  axis_begun_ = false;
  found_ = false;
}

std::uint8_t HomingSequence::searching() const noexcept {
  if (!axis_begun_) return 0;
  return static_cast<std::uint8_t>(1u << (homing_.order[step_] - 1));
}

/// The next axis begins when the platform has been at rest for kQuiet: only then does its integral say what it carries.
bool HomingSequence::isQuiet(const AxisValues& measured_m, rt::Nanoseconds now) noexcept {
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    // Positions, because one count alone is a velocity of several mm/s.
    if (std::abs(measured_m[i] - quiet_m_[i]) <= kQuiet_m) continue;
    quiet_m_ = measured_m;
    since_ = now;
  }
  return now - since_ >= kQuiet;
}

HomingSequence::Progress HomingSequence::step(const SupervisorView& view, rt::Nanoseconds now) noexcept {
  if (!axis_begun_) {
    axis_begun_ = isQuiet(view.measured.position_m, now);
    return Progress::Running;
  }
  const auto axis = static_cast<std::size_t>(homing_.order[step_] - 1);
  const AxisCommand& command = view.commands[axis];
  if (command.homing == HomingPhase::Failed) return Progress::Failed;
  if (command.homing != HomingPhase::Found) return Progress::Running;
  found_m_[axis] = command.home_m;
  ++step_;
  axis_begun_ = false;
  since_ = now;
  found_ = step_ >= homing_.order.size();
  return found_ ? Progress::Found : Progress::Running;
}

bool HomingSequence::end(bool faulted) noexcept {
  const bool found = found_ && !faulted;
  prepared_ = found_ = false;
  if (!found) return false;
  AxisValues lengths{};
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    lengths[i] = homing_.axes[i].length_m;
  homed_.fill(false);  // the stops say where the axes are, whatever was said before
  shift(lengths, found_m_);
  return true;
}

}  // namespace knee_robot::control
