#include "knee_robot/identification/plausible_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "test/identification/observe_one.h"
#include "test/identification/synthetic.h"

namespace knee_robot::identification {
namespace {

recording::Recording noisyRecording(const mechanism::Robot& robot) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 2.0);
  return syntheticRecording(robot, syntheticModel(robot), 0, 30.0, [&] { return normal(random); });
}

std::vector<std::string> doubtsAbout(const mechanism::Robot& robot, const recording::Recording& r) {
  IdentifyOptions options;
  options.uncertainty = false;
  std::vector<Observation> training = observeOne(robot, r, options);
  const Identification id = identify(robot, training, options);
  return doubtsAboutFit(robot, id.columns, id.parameters, training, options.observation);
}

bool hasAll(const std::vector<std::string>& doubts, const std::vector<std::string>& words) {
  if (doubts.size() != 1) return false;
  for (const std::string& word : words) {
    if (doubts.front().find(word) == std::string::npos) return false;
  }
  return true;
}

TEST(PlausibleFit, DoubtsNothingAboutAGoodFit) {
  for (const mechanism::Robot& robot : {syntheticRobot(), syntheticBench(4)})
    EXPECT_TRUE(doubtsAbout(robot, noisyRecording(robot)).empty());
}

TEST(PlausibleFit, TellsThatForcesAreInAnotherUnit) {
  const mechanism::Robot robot = syntheticRobot();
  recording::Recording r = noisyRecording(robot);
  r.force_N *= 1e-3;
  const std::vector<std::string> doubts = doubtsAbout(robot, r);
  EXPECT_TRUE(hasAll(doubts, {"times smaller at actuator", "is it in another unit"}))
      << (doubts.empty() ? "no doubt" : doubts.front());
}

TEST(PlausibleFit, TellsTheActuatorWhoseForceHasTheWrongSign) {
  for (const mechanism::Robot& robot : {syntheticRobot(), syntheticBench(2)}) {
    recording::Recording r = noisyRecording(robot);
    r.force_N.col(1) *= -1.0;
    const std::vector<std::string> doubts = doubtsAbout(robot, r);
    EXPECT_TRUE(hasAll(doubts, {"actuator 2: with the sign of its force reversed", "position"}))
        << (doubts.empty() ? "no doubt" : doubts.front());
  }
}

TEST(PlausibleFit, TellsThatAllForcesHaveTheWrongSign) {
  for (const mechanism::Robot& robot : {syntheticRobot(), syntheticBench(4)}) {
    recording::Recording r = noisyRecording(robot);
    r.force_N *= -1.0;
    const std::vector<std::string> doubts = doubtsAbout(robot, r);
    EXPECT_TRUE(hasAll(doubts, {"all actuators: with the signs of their forces reversed"}))
        << (doubts.empty() ? "no doubt" : doubts.front());
  }
}

TEST(PlausibleFit, TellsWhichColumnsWereExchanged) {
  for (const mechanism::Robot& robot : {syntheticRobot(), syntheticBench(4)}) {
    for (Eigen::MatrixXd recording::Recording::*columns :
         {&recording::Recording::force_N, &recording::Recording::position_m}) {
      recording::Recording r = noisyRecording(robot);
      if (robot.mechanism && columns == &recording::Recording::position_m) continue;  // other lengths, another pose
      (r.*columns).col(0).swap((r.*columns).col(1));
      const std::vector<std::string> doubts = doubtsAbout(robot, r);
      EXPECT_TRUE(
          hasAll(doubts, {"actuator 1, actuator 2: with their forces exchanged", "exchanged in the recording?"}))
          << (doubts.empty() ? "no doubt" : doubts.front());
    }
  }
}

/// Force rows stamped with the times of others.
recording::Recording withForcesOf(recording::Recording r, int rows_before) {
  const Eigen::MatrixXd force_N = r.force_N;
  for (Eigen::Index k = 0; k < force_N.rows(); ++k)
    r.force_N.row(k) = force_N.row(std::clamp<Eigen::Index>(k - rows_before, 0, force_N.rows() - 1));
  return r;
}

TEST(PlausibleFit, TellsByHowMuchTheClocksOfForcesAndPositionsDiffer) {
  const mechanism::Robot robot = syntheticRobot(), bench = syntheticBench(2);
  const std::vector<std::string> early = doubtsAbout(robot, withForcesOf(noisyRecording(robot), -20));
  EXPECT_TRUE(hasAll(early, {"recorded 0.2 s before", "different clocks"})) << (early.empty() ? "none" : early.front());
  const std::vector<std::string> late = doubtsAbout(bench, withForcesOf(noisyRecording(bench), 15));
  EXPECT_TRUE(hasAll(late, {"recorded 0.1", "s later", "different clocks"})) << (late.empty() ? "none" : late.front());
}

TEST(PlausibleFit, LeavesAShortDelayToTracing) {
  const mechanism::Robot robot = syntheticRobot();
  const std::vector<std::string> doubts = doubtsAbout(robot, withForcesOf(noisyRecording(robot), 2));
  EXPECT_TRUE(doubts.empty()) << doubts.front();
}

TEST(PlausibleFit, SaysOfForcesThatHaveNothingToDoWithTheMotionThatTheyAreNotDescribed) {
  const mechanism::Robot robot = syntheticBench(2);
  recording::Recording r = noisyRecording(robot);
  for (Eigen::Index k = 0; k < r.force_N.rows(); ++k)
    r.force_N(k, 0) = 50.0 * std::sin(2.0 * M_PI * 1.37 * r.time_s[static_cast<std::size_t>(k)]);
  const std::vector<std::string> doubts = doubtsAbout(robot, r);
  EXPECT_TRUE(hasAll(doubts, {"of the rms force", "at actuator 1.", "columns"}))
      << (doubts.empty() ? "no doubt" : doubts.front());
}

}  // namespace
}  // namespace knee_robot::identification
