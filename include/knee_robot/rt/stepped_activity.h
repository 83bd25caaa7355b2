#pragma once

#include <vector>

#include "knee_robot/rt/activity.h"

namespace knee_robot::rt {

/// The same order of execution as PeriodicActivity under a virtual clock: no thread, no waiting, the same result every
/// time.
class SteppedActivity final : public Activity {
 public:
  explicit SteppedActivity(ActivityOptions options) : Activity(std::move(options)) {}

  std::vector<std::string> start(Nanoseconds epoch) override;
  void stop() override { active_ = false; }
  bool isActive() const noexcept override { return active_; }
  bool mustHandOver() const noexcept override { return false; }

  /// Virtual time of the next cycle.
  Nanoseconds nextRelease() const { return index_ * options_.period; }
  /// Executes one cycle.
  void step() noexcept;
  /// Leaves out `cycles` cycles as a pause of the machine would; counted as one overrun.
  void skip(std::int64_t cycles) noexcept;

 private:
  std::int64_t index_ = 0;
  bool active_ = false;
};

/// Executes the one next cycle of several stepped activities: the earliest; at equal times that which comes first in
/// the list. Answers its time.
Nanoseconds stepEarliest(const std::vector<SteppedActivity*>& activities) noexcept;

}  // namespace knee_robot::rt
