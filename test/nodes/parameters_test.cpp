// A parameter of the wrong type is refused, and not taken for its default.
#include "src/nodes/parameters.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "knee_robot/base/errors.h"

namespace knee_robot::nodes {
namespace {

using XmlRpc::XmlRpcValue;

std::string complaint(const std::function<void()>& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(NumberParameter, IsAWholeOrADecimalNumberWithinItsLimits) {
  EXPECT_EQ(numberOf(XmlRpcValue(20), "/c/silent_guardian_ms", 5.0, 10000.0, "a silence"), 20.0);
  EXPECT_EQ(numberOf(XmlRpcValue(20.5), "/c/silent_guardian_ms", 5.0, 10000.0, "a silence"), 20.5);
  for (const double bad : {4.9, 10001.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_NE(complaint([&] { numberOf(XmlRpcValue(bad), "/c/silent_guardian_ms", 5.0, 10000.0, "a silence"); }), "");
}

TEST(NumberParameter, ThatIsNoneIsRefusedWithNameValueAndMeaning) {
  EXPECT_EQ(complaint([] {
              numberOf(XmlRpcValue("20ms"), "/c/silent_guardian_ms", 5.0, 10000.0, "the guardian's silence in ms");
            }),
            "parameter /c/silent_guardian_ms is '20ms', not a number; it is the guardian's silence in ms");
  EXPECT_NE(complaint([] { numberOf(XmlRpcValue(true), "/c/rate_hz", 1.0, 500.0, "the rate"); }), "");
  EXPECT_NE(complaint([] { numberOf(XmlRpcValue(), "/c/rate_hz", 1.0, 500.0, "the rate"); }), "");
}

TEST(SwitchParameter, IsTrueOrFalseAndNothingElse) {
  EXPECT_TRUE(switchOf(XmlRpcValue(true), "/c/empty", "whether nobody is on the robot"));
  EXPECT_FALSE(switchOf(XmlRpcValue(false), "/c/empty", "whether nobody is on the robot"));
  for (const XmlRpcValue& bad : {XmlRpcValue("maybe"), XmlRpcValue("true"), XmlRpcValue(1), XmlRpcValue(0.0)})
    EXPECT_NE(complaint([&] {
                switchOf(bad, "/c/empty", "whether nobody is on the robot");
              }).find("not true or false; it is whether nobody is on the robot"),
              std::string::npos);
}

TEST(TextParameter, IsNoNumber) {
  EXPECT_EQ(textOf(XmlRpcValue("knee"), "/c/shm", "a name"), "knee");
  EXPECT_NE(complaint([] { textOf(XmlRpcValue(7), "/c/shm", "a name"); }).find("is '7', not a text"),
            std::string::npos);
}

TEST(FolderParameter, IsAnAbsolutePath) {
  EXPECT_EQ(folderOf(XmlRpcValue("/var/knee"), "/c/state"), "/var/knee");
  for (const char* bad : {"", "knee", "./knee", "~/knee"})
    EXPECT_NE(complaint([&] { folderOf(XmlRpcValue(bad), "/c/state"); }).find("not an absolute path"),
              std::string::npos);
}

TEST(Parameter, OfTheWrongTypeCannotCommandTheTerminal) {
  EXPECT_EQ(complaint([] { textOf(XmlRpcValue(true), "/c/shm", "a name"); }),
            "parameter /c/shm is 'true', not a text; it is a name");
  EXPECT_EQ(complaint([] { switchOf(XmlRpcValue("\x1b[2J"), "/c/empty", "x"); }).find('\x1b'), std::string::npos);
}

}  // namespace
}  // namespace knee_robot::nodes
