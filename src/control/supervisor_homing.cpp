// How the axes learn where they are: see HomingMethod and HomingMove.
#include <cmath>

#include "knee_robot/control/supervisor.h"

namespace knee_robot::control {
namespace {

constexpr double kQuiet_m = 0.0002;
constexpr double kLargestShift_m = 0.005;
constexpr rt::Nanoseconds kQuiet = 500'000'000;

}  // namespace

/// Home: the procedure of the hardware file. ConfirmHome: the operator has put the robot at its home lengths.
void Supervisor::home(const Request& asked, rt::Nanoseconds now) {
  const HomingMethod method = hardware_.homing.method;
  const bool by_hand = method == HomingMethod::HandPlaced;
  if (by_hand != (asked.kind == RequestKind::ConfirmHome)) return answer(asked.number, RequestResult::NoProcedure);
  if (!isReady()) return answer(asked.number, RequestResult::NotReady);
  if (hardware_.homing.moves()) {
    homing_ = true;
    homing_step_ = 0;
    homing_axis_begun_ = false;
    home_found_ = false;
    enable(asked, now);
    return;
  }
  if (by_hand || !isHomed()) {
    AxisValues lengths{};
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      lengths[i] = robot_.actuators[i].home_length_m;
    for (std::size_t i = 0; i < hardware::kAxes && isHomed(); ++i) {
      const double shift = std::abs(lengths[i] - measured_.position_m[i]);
      if (shift > kLargestShift_m)
        return answer(asked.number, RequestResult::HomeShifted, static_cast<int>(i) + 1, shift);
    }
    setHome(lengths, measured_.position_m);
  }
  answer(asked.number, RequestResult::Done);
}

/// From the next cycle on, what is `measured` now counts as `lengths`.
void Supervisor::setHome(const AxisValues& lengths, const AxisValues& measured) noexcept {
  ++setting_.number;
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    setting_.shift_m[i] = lengths[i] - measured[i];
  home_setting.write(setting_);
  status_.homed.fill(true);
}

std::uint8_t Supervisor::homingBit() const noexcept {
  if (!homing_axis_begun_) return 0;
  return static_cast<std::uint8_t>(1u << (hardware_.homing.order[homing_step_] - 1));
}

/// The next axis begins when the platform has been at rest for kQuiet: only then does its integral say what it carries.
bool Supervisor::isQuietForHoming(rt::Nanoseconds now) noexcept {
  for (std::size_t i = 0; i < hardware::kAxes;
       ++i) {  // positions, because one count alone is a velocity of several mm/s
    if (std::abs(measured_.position_m[i] - quiet_m_[i]) <= kQuiet_m) continue;
    quiet_m_ = measured_.position_m;
    step_since_ = now;
  }
  return now - step_since_ >= kQuiet;
}

/// One axis after the other; then the safe stop, and only with the drives off the lengths are shifted: no loop ever sees a jump.
void Supervisor::advanceHoming(rt::Nanoseconds now) {
  if (!homing_axis_begun_) {
    homing_axis_begun_ = isQuietForHoming(now);
    return;
  }
  const auto axis = static_cast<std::size_t>(hardware_.homing.order[homing_step_] - 1);
  const AxisCommand& command = commands_[axis];
  if (command.homing == HomingPhase::Failed) return raise(Fault::HomingFailed, static_cast<int>(axis) + 1);
  if (command.homing != HomingPhase::Found) return;
  home_m_[axis] = command.home_m;
  ++homing_step_;
  homing_axis_begun_ = false;
  step_since_ = now;
  if (homing_step_ < hardware_.homing.order.size()) return;
  home_found_ = true;
  status_.state = MachineState::SafeStopping;
}

/// The safe stop is over. Whatever ended the homing before all axes were found: nothing has changed.
void Supervisor::endHoming() noexcept {
  const bool found = home_found_ && status_.fault == Fault::None;
  homing_ = home_found_ = false;
  if (!found) return;
  AxisValues lengths{};
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    lengths[i] = hardware_.homing.axes[i].length_m;
  setHome(lengths, home_m_);
}

}  // namespace knee_robot::control
