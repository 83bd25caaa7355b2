#include "../../src/nodes/impatient_launch.h"

#include <gtest/gtest.h>

namespace knee_robot::nodes {
namespace {

std::string asInProc(std::initializer_list<const char*> arguments) {
  std::string command;
  for (const char* one : arguments)
    command += std::string(one) + '\0';
  return command;
}

TEST(ImpatientLaunch, IsARoslaunchThatWasNotToldToWait) {
  EXPECT_TRUE(killsTooSoon(asInProc({"/usr/bin/python3", "/usr/bin/roslaunch", "knee_robot", "industrial_pc.launch"})));
  EXPECT_TRUE(killsTooSoon(asInProc({"python3", "/usr/bin/roslaunch", "--sigint-timeout=60", "a.launch"})));
  EXPECT_FALSE(killsTooSoon(asInProc({"python3", "/usr/bin/roslaunch", "--sigint-timeout=1e6", "a.launch"})));
  EXPECT_FALSE(killsTooSoon(asInProc({"python3", "/usr/bin/roslaunch", "--sigint-timeout", "100000", "a.launch"})));
  EXPECT_FALSE(killsTooSoon(asInProc({"/bin/bash"}))) << "whoever starts it from a shell kills it himself, or not";
  EXPECT_FALSE(killsTooSoon(""));
}

}  // namespace
}  // namespace knee_robot::nodes
