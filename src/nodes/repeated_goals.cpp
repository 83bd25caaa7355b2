#include "repeated_goals.h"

#include <functional>
#include <iterator>

#include "knee_robot/base/numbers.h"

namespace knee_robot::nodes {

std::string RepeatedGoals::whyNot(const std::string& goal, std::uint64_t stops, double now_s) {
  for (auto one = said_.begin(); one != said_.end();)
    one = now_s - one->second.at_s >= kQuiet_s ? said_.erase(one) : std::next(one);
  const auto [found, is_new] = said_.try_emplace(std::hash<std::string>()(goal), Said{now_s, stops, false});
  if (is_new) return "";
  const Said before = found->second;
  const bool refused = before.refused || before.stops != stops;
  found->second = {now_s, stops, refused};
  if (!refused) return "";
  return "the same goal came " + shortNumber(now_s - before.at_s, 2) +
         " s ago, and the robot has been stopped meanwhile: if a script or a bag says it again and again, end that; "
         "then wait " +
         shortNumber(kQuiet_s, 3) + " s, or send it with a client of the action (play_movement)";
}

}  // namespace knee_robot::nodes
