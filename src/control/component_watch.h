#pragma once

#include <vector>

#include "fault_latch.h"
#include "knee_robot/rt/task_context.h"

namespace knee_robot::control {

/// The components that must be Running while the drives are on. add() before the start; the rest is real-time safe.
class ComponentWatch {
 public:
  void add(const rt::TaskContext& component) { watched_.push_back(&component); }
  const std::vector<const rt::TaskContext*>& all() const noexcept { return watched_; }
  bool allRun() const noexcept;
  /// The first component that failed or was stopped, with its index; no fault: none. Stopped ones are none where
  /// `may_stand`.
  FaultCause firstFailure(bool may_stand) const noexcept;

 private:
  std::vector<const rt::TaskContext*> watched_;
};

}  // namespace knee_robot::control
