// What is long goes on in the next line: the end of a fault's sentence says what to do.
#include "../../src/nodes/monitor_text.h"

#include <gtest/gtest.h>

namespace knee_robot::nodes {
namespace {

using Lines = std::vector<std::string>;

TEST(MonitorText, BreaksLongLinesAtBlanksAndGoesOnBelowTheText) {
  EXPECT_EQ(brokenLines({"FAULT        runaway: it runs away; check the wiring", "fault        none"}, 30),
            (Lines{"FAULT        runaway: it runs", "             away; check the", "             wiring",
                   "fault        none"}));
}

TEST(MonitorText, LosesNothingOfAWordThatIsTooLong) {
  EXPECT_EQ(brokenLines({"FAULT        " + std::string(20, 'x')}, 30),
            (Lines{"FAULT        " + std::string(17, 'x'), "             xxx"}));
  EXPECT_EQ(brokenLines({std::string(30, 'x'), ""}, 30), (Lines{std::string(30, 'x'), ""}));
}

}  // namespace
}  // namespace knee_robot::nodes
