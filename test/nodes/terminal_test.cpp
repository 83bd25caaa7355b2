// Whoever asks for something cannot write on the terminal of the one who watches.
#include "src/nodes/terminal.h"

#include <gtest/gtest.h>
#include <ros/console.h>

#include <string>

namespace knee_robot::nodes {
namespace {

std::string shownOf(const std::string& request, const control::Answer& answer) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  showAnswer(request, answer);
  const std::string out = testing::internal::GetCapturedStdout();
  return out + testing::internal::GetCapturedStderr();
}

TEST(Terminal, ShowsTheAnswerToARequest) {
  EXPECT_NE(shownOf("stop", {true, "the robot holds"}).find("stop: the robot holds"), std::string::npos);
  const std::string refused = shownOf("load_reference", {false, "a.txt: no such file"});
  EXPECT_NE(refused.find("load_reference refused: a.txt: no such file"), std::string::npos) << refused;
}

TEST(Terminal, ObeysNobodysFileName) {
  const std::string name = "a\x1b]0;title\x07\x1b[2J\n[ERROR] forged\xc2\x9bm";
  const std::string shown = shownOf("load_reference", {false, name});
  EXPECT_NE(shown.find(R"(a\x1b]0;title\x07\x1b[2J\n[ERROR] forged\xc2\x9bm)"), std::string::npos) << shown;
  EXPECT_NE(shownOf("a\x1b[2J", {true, "b"}).find(R"(a\x1b[2J: b)"), std::string::npos);
}

}  // namespace
}  // namespace knee_robot::nodes
