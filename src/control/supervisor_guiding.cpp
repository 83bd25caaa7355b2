// Hand guiding: when it may begin, and what ends it.
#include <algorithm>

#include "knee_robot/control/supervisor.h"

namespace knee_robot::control {
namespace {

constexpr int kSilentGuide = 5;  // cycles; the Drivers hold by then

}  // namespace

/// Once a cycle. A switch that was not let go of since the robot was enabled is held down by something else than a hand: it begins nothing.
void Supervisor::readGuide() noexcept {
  const bool heard = guidance.read(guide_) == rt::FlowStatus::NewData;
  unguided_ = heard ? 0 : unguided_ + 1;
  const bool held = hardware_.enabling_switch_bit && !inputIsLow(hardware_.enabling_switch_bit) &&
                    measured_.sequence != 0 && unreadable_ == 0;
  if (measured_.sequence != 0 && unreadable_ == 0 && inputIsLow(hardware_.enabling_switch_bit))
    switch_was_released_ = true;
  switch_held_ = held;
}

bool Supervisor::brakesWereTested() const noexcept {
  return brake_test > 0.0 && std::all_of(hardware_.axes.begin(), hardware_.axes.end(),
                                         [](const auto& axis) { return axis.hold_device == HoldDevice::Brake; });
}

void Supervisor::guide(const Request& asked) {
  settlePending(RequestResult::Superseded);
  const auto refuse = [&](RequestResult why) { answer(asked.number, why); };
  if (!hardware_.enabling_switch_bit) return refuse(RequestResult::NoEnablingSwitch);
  if (!guidance.isConnected()) return refuse(RequestResult::NoGuide);
  if (!brakesWereTested()) return refuse(RequestResult::BrakesUntested);
  if (!isReady() || unguided_ > kSilentGuide) return refuse(RequestResult::NotReady);
  if (!switch_held_) return refuse(RequestResult::SwitchNotHeld);
  if (!switch_was_released_) return refuse(RequestResult::SwitchNotReleased);
  if (guide_.stop != GuideStop::None) {
    status_.guide_stop = guide_.stop;
    return refuse(RequestResult::GuideRefused);
  }
  switch_was_released_ = false;
  status_.guide_stop = GuideStop::None;
  status_.state = MachineState::Guiding;
  answer(asked.number, RequestResult::Done);
}

/// Letting go of the switch, and everything that HandGuide says, ends in holding.
void Supervisor::advanceGuiding() noexcept {
  if (unguided_ > kSilentGuide) status_.guide_stop = GuideStop::Silent;
  if (unguided_ <= kSilentGuide && guide_.stop != GuideStop::None) status_.guide_stop = guide_.stop;
  if (!switch_held_ || status_.guide_stop != GuideStop::None) status_.state = MachineState::Holding;
}

}  // namespace knee_robot::control
