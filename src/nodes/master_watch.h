#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace knee_robot::nodes {

/// Asks the ROS master twice a second, from a thread of its own, whether it is there and still sends clients of
/// ~get_state and of what stops the robot to this process. A master that was restarted knows nobody, and any node may
/// take a service's name, or withdraw it, without a word to its owner: then what is advertised has to be advertised
/// anew. Then it calls ~get_state over a connection of its own: where no descriptor is left, or no thread, a master that
/// answers helps nobody who wants to stop the robot.
class MasterWatch {
 public:
  /// Resolved names: of ~get_state, which is advertised last, and of the others.
  MasterWatch(std::string service, std::vector<std::string> others);
  ~MasterWatch();

  /// Seconds since the master answered last.
  double silence() const { return since(answered_); }
  /// Seconds since a new client was answered last.
  double sinceReached() const { return since(reached_); }
  /// The master answered, and does not know a service, or sends its clients to somebody else.
  bool isForgotten() const { return forgotten_; }
  /// It sends the clients of one of them to somebody else.
  bool isRobbed() const { return robbed_; }
  /// After everything was advertised anew: until the master says otherwise.
  void remember() { forgotten_ = robbed_ = false; }

 private:
  using Clock = std::chrono::steady_clock;
  void run();
  bool finds(const std::string& service);
  bool findsAll();
  static double since(Clock::rep time);

  const std::string service_;
  const std::vector<std::string> others_;
  std::atomic<Clock::rep> answered_, reached_;
  std::atomic<bool> forgotten_{false}, robbed_{false};
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

}  // namespace knee_robot::nodes
