#pragma once

#include <ros/callback_queue.h>

#include <cstdint>
#include <functional>

#include "knee_robot/control/wishes_so_far.h"

namespace knee_robot::nodes {

/// A callback queue whose callbacks know which stops and pauses there had been when they came in: a request that has
/// waited for a thread (others wait for a disk) is older than a stop that was answered meanwhile.
class StampedQueue : public ros::CallbackQueue {
 public:
  /// `stops` is asked by whoever adds a callback: it must not wait for anything.
  explicit StampedQueue(std::function<control::WishesSoFar()> stops) : stops_(std::move(stops)) {}

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t removal_id = 0) override;
  /// Within a callback of such a queue: those of when it came in.
  static control::WishesSoFar stamp() noexcept;

 private:
  const std::function<control::WishesSoFar()> stops_;
};

}  // namespace knee_robot::nodes
