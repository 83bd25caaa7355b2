// What a ROS node says of itself where no ROS master is.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <regex>
#include <string>

#include "knee_robot/base/files.h"

namespace {

struct Ended {
  int status;
  std::string output;
};

Ended runWithoutMaster(const std::string& program, const std::string& arguments) {
  const std::string command =
      "ROS_MASTER_URI=http://127.0.0.1:9 timeout 60 " + program + " " + arguments + " 2>&1 < /dev/null";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return {-1, ""};
  std::string output;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe))
    output += static_cast<char>(c);
  const int status = ::pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, output};
}

TEST(NodeHelp, ControllerNamesWithoutAMasterEveryParameterThatItsLaunchFileSets) {
  const Ended help = runWithoutMaster(KNEE_CONTROLLER, "--help");
  EXPECT_EQ(0, help.status) << help.output;
  const std::string launch = knee_robot::readFile(std::string(KNEE_SOURCE_DIR) + "/launch/controller.launch");
  const std::size_t begin = launch.find("<node name=\"controller\"");
  ASSERT_NE(std::string::npos, begin);
  const std::string node = launch.substr(begin, launch.find("</node>", begin) - begin);
  const std::regex param("<param [^>]*name=\"([a-z_]+)\"");
  int count = 0;
  for (std::sregex_iterator it(node.begin(), node.end(), param), end; it != end; ++it, ++count)
    EXPECT_NE(std::string::npos, help.output.find("~" + (*it)[1].str())) << (*it)[1];
  EXPECT_GT(count, 10);
}

TEST(NodeHelp, ControllerRefusesAWordThatItDoesNotKnow) {
  const Ended refused = runWithoutMaster(KNEE_CONTROLLER, "--rate 50");
  EXPECT_EQ(2, refused.status);
  EXPECT_NE(std::string::npos, refused.output.find("--rate")) << refused.output;
}

TEST(NodeHelp, MonitorsSayWithoutAMasterWhatTheyAreFor) {
  for (const std::string program : {KNEE_MONITOR, KNEE_MONITOR_MARKERS}) {
    const Ended help = runWithoutMaster(program, "--help");
    EXPECT_EQ(0, help.status) << help.output;
    EXPECT_NE(std::string::npos, help.output.find("Shows")) << help.output;
  }
}

}  // namespace
