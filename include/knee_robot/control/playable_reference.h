#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <utility>

#include "knee_robot/trajectory/reference_check.h"

namespace knee_robot::control {

/// A reference that has passed every check of one ControlSystem's robot (ControlSystem::check()). Only that makes one,
/// so nothing else can be handed over, and none is checked twice; of a patient it says nothing.
class PlayableReference {
 public:
  const trajectory::Reference& reference() const { return reference_; }
  const trajectory::ReferenceCheck& check() const { return check_; }
  /// Whether it was that robot's limits; by address.
  bool wasCheckedFor(const mechanism::Robot& robot) const { return robot_ == &robot; }
  /// From 1, a new one with each check: two of one name may be of two contents of the file.
  std::uint64_t number() const { return number_; }
  /// How it is called from now on.
  void rename(std::string name) { reference_.name = std::move(name); }

 private:
  friend class PathPlayer;
  /// InputError: the first limit that it breaks.
  PlayableReference(trajectory::Reference reference, const mechanism::Robot& robot)
      : reference_(std::move(reference)), check_(trajectory::requirePlayable(reference_, robot)), robot_(&robot) {
    static std::atomic<std::uint64_t> checks{0};
    number_ = ++checks;
  }

  trajectory::Reference reference_;
  trajectory::ReferenceCheck check_;
  const mechanism::Robot* robot_;
  std::uint64_t number_ = 0;
};

}  // namespace knee_robot::control
