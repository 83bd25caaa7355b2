#include "../../src/nodes/repeated_goals.h"

#include <gtest/gtest.h>

namespace knee_robot::nodes {
namespace {

constexpr double kQuiet_s = RepeatedGoals::kQuiet_s;

TEST(RepeatedGoals, ArePlayedAgainAsLongAsNobodyStopsTheRobot) {
  RepeatedGoals goals;
  for (int k = 0; k < 100; ++k)
    EXPECT_EQ(goals.whyNot("there", 7, k), "");
}

TEST(RepeatedGoals, AreRefusedAfterAStopForAsLongAsTheyGoOn) {
  RepeatedGoals goals;
  EXPECT_EQ(goals.whyNot("there", 7, 0.0), "");
  EXPECT_NE(goals.whyNot("there", 8, 1.0).find("came 1 s ago"), std::string::npos);
  double now_s = 1.0;
  for (int k = 0; k < 5; ++k)
    EXPECT_NE(goals.whyNot("there", 8, now_s += 0.9 * kQuiet_s), "");
  EXPECT_EQ(goals.whyNot("there", 8, now_s + kQuiet_s), "") << "nobody has said it for a while";
}

TEST(RepeatedGoals, LeaveOtherGoalsAlone) {
  RepeatedGoals goals;
  EXPECT_EQ(goals.whyNot("there", 7, 0.0), "");
  EXPECT_EQ(goals.whyNot("back", 8, 1.0), "");
  EXPECT_NE(goals.whyNot("there", 8, 2.0), "") << "said in turn with another one";
  EXPECT_EQ(goals.whyNot("back", 8, 3.0), "");
}

}  // namespace
}  // namespace knee_robot::nodes
