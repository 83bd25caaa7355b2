// The encoders' common supply is lost at rest: nothing counts, nothing looks like a disturbance, and whoever pushes
// takes the platform along.
#include "holding_robot.h"
#include "src/control/rest_turn.h"

namespace knee_robot::control {
namespace {

using namespace holding;

void loseSupply(HoldingRobot& robot) {
  for (std::size_t axis = 0; axis < hardware::kAxes; ++axis)
    robot.freeze(axis);
}

std::uint32_t questionsOf(const HoldingRobot& robot) {
  const std::optional<Disturbance> now = robot.system->disturbance();
  return now ? now->questions : 0;
}

TEST(LostEncoderSupply, IsFoundAtRestWithinTheTimeBetweenTwoQuestionsAndThePlatformStaysUp) {
  for (const double payload_kg : {0.0, 15.0}) {
    Truth truth;
    truth.payload_kg = payload_kg;
    HoldingRobot robot(truth);
    const double height = robot.lowest = robot.plant.state().pose[1];
    loseSupply(robot);
    EXPECT_TRUE(robot.system->waitFor(MachineState::Faulted, 31.0)) << payload_kg << " kg";
    EXPECT_EQ(robot.system->status().fault_name, "encoder_frozen");
    EXPECT_LT(height - robot.lowest, 0.005);
  }
}

TEST(LostEncoderSupply, AHealthyRobotThatNobodyTouchesIsAskedTwiceAMinuteAtMostAndStaysWhereItIs) {
  HoldingRobot robot;
  const mechanism::Pose stood = robot.plant.state().pose;
  const std::uint32_t before = questionsOf(robot);
  robot.system->run(300.0);
  EXPECT_EQ(robot.system->state(), MachineState::Holding) << robot.system->status().fault_sentence;
  EXPECT_GE(questionsOf(robot), before + 3);
  EXPECT_LE(questionsOf(robot), before + 10);
  EXPECT_LT((robot.plant.state().pose - stood).cwiseAbs().maxCoeff(), 5e-4);
}

TEST(LostEncoderSupply, WhereAnAxisCountsNobodyIsAsked) {
  RestTurn turn;
  RestTurn::Counts counts{};
  for (int k = 0; k < 100'000; ++k) {
    counts[2] = 3 * (k / 20'000 % 2);  // every 20 s
    ASSERT_EQ(turn.step(true, 0.001, counts, 30.0), -1) << k;
  }
}

TEST(LostEncoderSupply, TheAxesTakeTurnsAndAMotionBeginsTheTimeAnew) {
  RestTurn turn;
  std::vector<int> asked;
  for (int k = 0; k < 150'000; ++k) {
    const int axis = turn.step(k < 100'000 || k >= 101'000, 0.001, {}, 30.0);
    if (axis >= 0) asked.push_back(axis);
  }
  EXPECT_EQ(asked, (std::vector<int>{0, 1, 2, 3}));
}

}  // namespace
}  // namespace knee_robot::control
