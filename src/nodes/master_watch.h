#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

namespace knee_robot::nodes {

/// Asks the ROS master twice a second, from a thread of its own, whether it is there and still knows ~get_state of this
/// node. A master that was restarted knows nobody: then what is advertised has to be advertised anew. Then it calls
/// that service over a connection of its own: where no descriptor is left, or no thread, a master that answers helps
/// nobody who wants to stop the robot.
class MasterWatch {
 public:
  /// `service`: the resolved name of ~get_state.
  explicit MasterWatch(std::string service);
  ~MasterWatch();

  /// Seconds since the master answered last.
  double silence() const { return since(answered_); }
  /// Seconds since a new client was answered last.
  double sinceReached() const { return since(reached_); }
  /// The master answered, and does not know the service.
  bool isForgotten() const { return forgotten_; }
  /// After everything was advertised anew: until the master says otherwise.
  void remember() { forgotten_ = false; }

 private:
  using Clock = std::chrono::steady_clock;
  void run();
  bool findsItself() const;
  static double since(Clock::rep time);

  const std::string service_;
  std::atomic<Clock::rep> answered_, reached_;
  std::atomic<bool> forgotten_{false};
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

}  // namespace knee_robot::nodes
