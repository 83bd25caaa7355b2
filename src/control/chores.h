#pragma once

#include <atomic>
#include <functional>
#include <thread>
#include <vector>

namespace knee_robot::control {

/// What the controller writes down every two seconds while it runs (who is on the robot, the motors' heat), in a thread
/// of its own beside the real-time threads. One after the other: all of it lies on one disk, and where that hangs
/// nothing but this thread waits. A chore that throws is tried again the next time.
class Chores {
 public:
  static constexpr double kPeriod_s = 2.0;

  /// All that the chores use must outlive this. Not `threaded`: none is done.
  Chores(bool threaded, std::vector<std::function<void()>> chores, double period_s = kPeriod_s);
  ~Chores();
  Chores(const Chores&) = delete;
  Chores& operator=(const Chores&) = delete;

 private:
  void loop();

  const std::vector<std::function<void()>> chores_;
  const double period_s_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace knee_robot::control
