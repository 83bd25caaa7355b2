#include "guiding_permission.h"

namespace knee_robot::control {
namespace {

constexpr int kSilentGuide = 5;  // cycles; the Drivers hold by then

}  // namespace

void GuidingPermission::readSwitch(const SupervisorView& view) noexcept {
  const bool known = view.unreadable == 0;
  held_ = known && inputs_.enablingSwitchHeld(view.measured);
  if (known && inputs_.enablingSwitchReleased(view.measured)) released_ = true;
}

RequestResult GuidingPermission::begin(const SupervisorView& view, const Conditions& conditions) noexcept {
  if (!inputs_.hasEnablingSwitch()) return RequestResult::NoEnablingSwitch;
  if (!conditions.has_guide) return RequestResult::NoGuide;
  if (!conditions.brakes_tested) return RequestResult::BrakesUntested;
  if (!conditions.ready || view.unguided > kSilentGuide) return RequestResult::NotReady;
  if (!held_) return RequestResult::SwitchNotHeld;
  if (!released_) return RequestResult::SwitchNotReleased;
  if (view.guidance.stop != GuideStop::None) {
    stop_ = view.guidance.stop;
    return RequestResult::GuideRefused;
  }
  released_ = false;
  stop_ = GuideStop::None;
  return RequestResult::Done;
}

bool GuidingPermission::goesOn(const SupervisorView& view) noexcept {
  if (view.unguided > kSilentGuide)
    stop_ = GuideStop::Silent;
  else if (view.guidance.stop != GuideStop::None)
    stop_ = view.guidance.stop;
  return held_ && stop_ == GuideStop::None;
}

}  // namespace knee_robot::control
