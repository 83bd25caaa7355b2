#include <gtest/gtest.h>

#include <cmath>

#include "knee_robot/identification/recording_units.h"
#include "test/identification/synthetic.h"
#include "test/mechanism/configured_robot.h"
#include "test/refusal.h"

namespace knee_robot::identification {
namespace {

/// Four axes that swing by 5 cm, counted in steps of `step_m`; 0: not counted at all. Written with `digits_m`.
std::vector<recording::Recording> counted(double step_m, double digits_m = 0.0) {
  constexpr int kRows = 3000;
  recording::Recording r;
  r.axes = 4;
  r.position_m.resize(kRows, 4);
  for (int n = 0; n < kRows; ++n) {
    for (int i = 0; i < 4; ++i) {
      double position_m = 0.7 + 0.05 * std::sin(0.002 * n * (1.0 + 0.3 * i));
      for (const double grid_m : {step_m, digits_m})
        position_m = grid_m > 0.0 ? grid_m * std::round(position_m / grid_m) : position_m;
      r.position_m(n, i) = position_m;
    }
  }
  return {r};
}

TEST(RecordedSteps, TakeThePlaceOfTheRobotFilesAndAreSaid) {
  mechanism::Robot robot = mechanism::configuredRobot("B");
  const double fourth_m = robot.actuators[3].metresPerCount();
  std::vector<recording::Recording> recordings = counted(1e-6);
  takeRecordedSteps(robot, recordings);
  for (const mechanism::Actuator& a : robot.actuators)
    EXPECT_NEAR(a.metresPerCount(), 1e-6, 1e-9);
  ASSERT_EQ(recordings.front().notes.size(), 4u);
  EXPECT_NE(recordings.front().notes[3].find("steps of 1 um, by the robot file they are " +
                                             std::to_string(1e6 * fourth_m).substr(0, 4)),
            std::string::npos)
      << recordings.front().notes[3];
}

TEST(RecordedSteps, ThatAreTheRobotFilesChangeNothing) {
  mechanism::Robot robot = mechanism::configuredRobot("B");
  const double step_m = robot.actuators[0].metresPerCount(), fourth_m = robot.actuators[3].metresPerCount();
  std::vector<recording::Recording> recordings = counted(step_m);
  takeRecordedSteps(robot, recordings);
  EXPECT_EQ(robot.actuators[0].metresPerCount(), step_m);
  EXPECT_NE(robot.actuators[3].metresPerCount(), fourth_m);
  EXPECT_EQ(recordings.front().notes.size(), 1u);
}

TEST(RecordedSteps, AreNotReadOffPositionsThatLieOnNoGrid) {
  mechanism::Robot robot = mechanism::configuredRobot("B");
  const mechanism::Robot before = robot;
  std::vector<recording::Recording> filtered = counted(0.0), rounded = counted(2.325e-6, 1e-6);
  takeRecordedSteps(robot, filtered);
  takeRecordedSteps(robot, rounded);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(robot.actuators[i].metresPerCount(), before.actuators[i].metresPerCount());
  EXPECT_TRUE(filtered.front().notes.empty() && rounded.front().notes.empty());
}

TEST(RecordedRange, PositionsInMillimetresAreRefusedOnABench) {
  mechanism::Robot robot = syntheticBench(2);
  for (mechanism::Actuator& a : robot.actuators) {
    a.position_min_m = 0.0;
    a.position_max_m = 0.5;
  }
  recording::Recording good = syntheticRecording(robot, syntheticModel(robot), 0, 5.0);
  good.position_unit.assign(2, "m");
  recording::Recording r = good;
  EXPECT_EQ("", refusalOf([&] { toActuatorUnits(robot, r); }));
  r.position_m.array() -= 0.3;  // counted from elsewhere
  EXPECT_EQ("", refusalOf([&] { toActuatorUnits(robot, r); }));
  for (const double unit : {1e3, 1e2, -1e3}) {
    r = good;
    r.position_m.col(1) *= unit;
    const std::string said = refusalOf([&] { toActuatorUnits(robot, r); });
    EXPECT_NE(said.find("position_2_m: "), std::string::npos) << said;
    EXPECT_NE(said.find(unit > 0 ? "outside position_max_m 0.5" : "outside position_min_m 0"), std::string::npos)
        << said;
    EXPECT_NE(said.find("millimetres?"), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace knee_robot::identification
