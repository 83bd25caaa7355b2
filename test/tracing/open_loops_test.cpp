// Which axes' surrogates are believed in closed loop.
#include <gtest/gtest.h>

#include "src/tracing/closed_loop_surrogate.h"

namespace knee_robot::tracing {
namespace {

class OpenLoops : public testing::Test {
 protected:
  OpenLoops() : plans_(2) {
    for (SurrogatePlan& plan : plans_) {
      plan.open_loop.assign(4, 0);
      plan.sticks_too_much.assign(4, 0);
    }
  }
  /// Axes whose loop is open after surrogates have left so much of what the recording leaves (1 N).
  std::vector<char> after(const Eigen::Vector4d& left_N) {
    notes_ = openLoops(left_N, Eigen::Vector4d::Ones(), plans_);
    EXPECT_EQ(plans_[0].open_loop, plans_[1].open_loop);
    return plans_[0].open_loop;
  }

  std::vector<SurrogatePlan> plans_;
  std::vector<std::string> notes_;
};

TEST_F(OpenLoops, StayClosedWhereSurrogatesLeaveAboutAsMuch) {
  EXPECT_EQ(after({1.3, 0.5, 1.0, 1.39}), (std::vector<char>{0, 0, 0, 0}));
  EXPECT_TRUE(notes_.empty());
}

TEST_F(OpenLoops, OpenWhereASurrogateLeavesMuchMore) {
  EXPECT_EQ(after({1.0, 3.0, 1.0, 2.0}), (std::vector<char>{0, 1, 0, 1})) << "half of the axes are not most of them";
  ASSERT_EQ(notes_.size(), 2u);
  EXPECT_EQ(notes_[0].find("Actuator 2: a surrogate in closed loop leaves 3 N, more than the recording (1 N)"), 0u);
}

TEST_F(OpenLoops, OpenWhereAControllerWasRecoveredInHalfOfTheRecordingsOnly) {
  plans_[1].open_loop[2] = 1;
  EXPECT_EQ(after({1.0, 1.0, 1.0, 1.0}), (std::vector<char>{0, 0, 1, 0}));
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_EQ(notes_[0].find("Actuator 3: its controller was recovered in 1 of 2 recordings only"), 0u) << notes_[0];
}

TEST_F(OpenLoops, OpenEverywhereWhereMostSurrogatesLeaveMuchMore) {
  EXPECT_EQ(after({9.0, 3.0, 5.0, 0.9}), (std::vector<char>{1, 1, 1, 1}));
  ASSERT_EQ(notes_.size(), 4u);
  EXPECT_NE(notes_[3].find("most other actuators"), std::string::npos) << notes_[3];
}

TEST_F(OpenLoops, OpenWhereASurrogateStandsStillAndTheMachineDoesNot) {
  plans_[1].sticks_too_much = {0, 1, 0, 0};
  EXPECT_EQ(after({1.0, 1.2, 1.0, 1.0}), (std::vector<char>{0, 1, 0, 0}));
  ASSERT_EQ(notes_.size(), 1u);
  EXPECT_NE(notes_[0].find("stands still where the machine does not"), std::string::npos) << notes_[0];
}

TEST_F(OpenLoops, CountOnlyAxesThatWereClosed) {
  for (SurrogatePlan& plan : plans_)
    plan.open_loop = {1, 1, 0, 0};
  EXPECT_EQ(after({9.0, 9.0, 9.0, 1.0}), (std::vector<char>{1, 1, 1, 0})) << "one of two is not most";
  EXPECT_EQ(notes_.size(), 1u);
}

TEST_F(OpenLoops, OpenAnAxisThatIsClosedInOneOfTheRecordingsOnly) {
  plans_[0].open_loop = {0, 1, 0, 0};  // whose controller was not recovered there
  EXPECT_EQ(after({1.0, 5.0, 1.0, 1.0}), (std::vector<char>{0, 1, 0, 0}));
  EXPECT_EQ(notes_.size(), 1u);
}

}  // namespace
}  // namespace knee_robot::tracing
