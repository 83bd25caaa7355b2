#include "knee_robot/rt/stepped_activity.h"

namespace knee_robot::rt {

std::vector<std::string> SteppedActivity::start(Nanoseconds /*epoch*/) {
  active_ = true;
  return {};
}

void SteppedActivity::step() noexcept {
  if (!active_) return;
  runCycle(index_, index_ * options_.period, 0, false);
  statistics_.lateness.add(0);
  countPunctual();
  ++index_;
}

void SteppedActivity::skip(std::int64_t cycles) noexcept {
  index_ += cycles;
  countOverrun(cycles);
}

Nanoseconds stepEarliest(const std::vector<SteppedActivity*>& activities) noexcept {
  SteppedActivity* earliest = nullptr;
  for (SteppedActivity* activity : activities) {
    if (earliest == nullptr || activity->nextRelease() < earliest->nextRelease()) earliest = activity;
  }
  if (earliest == nullptr) return 0;
  const Nanoseconds time = earliest->nextRelease();
  earliest->step();
  return time;
}

}  // namespace knee_robot::rt
