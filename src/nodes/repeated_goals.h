#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

namespace knee_robot::nodes {

/// Goals that something says again and again (`rostopic pub -r 1`, a bag that is played in a loop): once the robot was
/// stopped, they would set it going again within a second. So a goal that was said before the robot was stopped is
/// refused until it has not been said for kQuiet_s. A client's goals have an id each and are never the same.
class RepeatedGoals {
 public:
  static constexpr double kQuiet_s = 30.0;

  /// `goal`: all that it says; `stops`: another number whenever the robot was stopped. Empty: it may be played.
  std::string whyNot(const std::string& goal, std::uint64_t stops, double now_s);

 private:
  struct Said {
    double at_s = 0.0;
    std::uint64_t stops = 0;
    bool refused = false;
  };

  std::map<std::size_t, Said> said_;  // by the goal's hash
};

}  // namespace knee_robot::nodes
