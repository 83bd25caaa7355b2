#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

namespace knee_robot::nodes {

/// Asks the ROS master twice a second, from a thread of its own, whether it is there and still knows `service` of this node. A
/// master that was restarted knows nobody: then what is advertised has to be advertised anew.
class MasterWatch {
 public:
  /// `service`: resolved name of a service that this node advertises.
  explicit MasterWatch(std::string service);
  ~MasterWatch();

  /// Seconds since the master answered last.
  double silence() const;
  /// The master answered, and does not know the service.
  bool isForgotten() const { return forgotten_; }
  /// After everything was advertised anew: until the master says otherwise.
  void remember() { forgotten_ = false; }

 private:
  void run();
  using Clock = std::chrono::steady_clock;

  const std::string service_;
  std::atomic<Clock::rep> answered_;
  std::atomic<bool> forgotten_{false};
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

}  // namespace knee_robot::nodes
