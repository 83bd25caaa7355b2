#pragma once

#include <ros/callback_queue.h>

#include <cstdint>
#include <functional>

namespace knee_robot::nodes {

/// A callback queue whose callbacks know what a counter stood at when they came in: a request that has waited for a
/// thread (others wait for a disk) is older than a stop that was answered meanwhile.
class StampedQueue : public ros::CallbackQueue {
 public:
  /// `counter` is asked by whoever adds a callback: it must not wait for anything.
  explicit StampedQueue(std::function<std::uint64_t()> counter) : counter_(std::move(counter)) {}

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t removal_id = 0) override;
  /// Within a callback of such a queue: what the counter stood at when it came in.
  static std::uint64_t stamp() noexcept;

 private:
  const std::function<std::uint64_t()> counter_;
};

}  // namespace knee_robot::nodes
