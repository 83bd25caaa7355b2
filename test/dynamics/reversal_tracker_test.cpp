// Where a path that is told by its steps has turned.
#include <gtest/gtest.h>

#include "knee_robot/dynamics/acting_effects.h"

namespace knee_robot::dynamics {
namespace {

TEST(ReversalTracker, TellsWayAndTimeSinceTheTurningPoint) {
  ReversalTracker path;
  constexpr double kFlicker_m = 1e-5, kPeriod_s = 0.01;
  const auto move = [&](double step_m, int times) {
    SinceReversal since;
    for (int k = 0; k < times; ++k)
      since = path.step(step_m, kPeriod_s, kFlicker_m);
    return since;
  };
  SinceReversal since = move(1e-4, 50);
  EXPECT_NEAR(since.way_m, 5e-3, 1e-12) << "since it began";
  EXPECT_NEAR(since.time_s, 0.5, 1e-12);
  since = move(-4e-6, 2);
  EXPECT_NEAR(since.time_s, 0.52, 1e-12) << "flicker is no reversal";
  since = move(-1e-4, 10);
  EXPECT_NEAR(since.way_m, 1e-3 + 8e-6, 1e-12);
  EXPECT_NEAR(since.time_s, 0.12, 1e-12) << "since the turning point was left, not since it was noticed";
  since = move(0.0, 100);
  EXPECT_NEAR(since.way_m, 1e-3 + 8e-6, 1e-12) << "rest is no reversal";
  EXPECT_NEAR(since.time_s, 1.12, 1e-12);
}

TEST(ReversalTracker, ForgetsAWayBackThatTheStrokeHasPassedAgain) {
  ReversalTracker path;
  const auto move = [&](double step_m, int times) {
    double way_m = 0.0;
    for (int k = 0; k < times; ++k)
      way_m = path.step(step_m, 0.01, 1e-5).way_m;
    return way_m;
  };
  move(-1e-4, 20);
  EXPECT_NEAR(move(1e-4, 50), 5e-3, 1e-12);
  EXPECT_NEAR(move(-1e-4, 10), 1e-3, 1e-12) << "on the way back";
  EXPECT_NEAR(move(1e-4, 4), 4e-4, 1e-12) << "and forth again";
  EXPECT_NEAR(move(-1e-4, 2), 2e-4, 1e-12) << "a loop within the loop";
  EXPECT_NEAR(move(1e-4, 3), 5e-4, 1e-12) << "which closes";
  EXPECT_NEAR(move(1e-4, 10), 5.5e-3, 1e-12) << "past the point where it turned back: one stroke of 5.5 mm";
  for (int k = 0; k < 1000; ++k)  // ever smaller loops, more than are remembered
    move(k % 2 == 0 ? -1e-4 : 1e-4, k < 100 ? 100 - k : 1);
  EXPECT_LE(move(1e-4, 1), 11e-3);
}

TEST(ReversalTracker, KnowsWhereThePathTurnedLastWhateverStrokeItIsIn) {
  ReversalTracker path;
  const auto move = [&](double step_m, int times) {
    double way_m = 0.0;
    for (int k = 0; k < times; ++k)
      way_m = path.step(step_m, 0.01, 1e-5).way_of_last_m;
    return way_m;
  };
  EXPECT_NEAR(move(1e-4, 50), 5e-3, 1e-12) << "since it began";
  EXPECT_NEAR(move(-1e-4, 10), 1e-3, 1e-12);
  EXPECT_NEAR(move(1e-4, 20), 2e-3, 1e-12) << "past the point where it turned back";
  EXPECT_NEAR(move(-5e-6, 1), 1.995e-3, 1e-12) << "flicker is no reversal";
}

TEST(ReversalTracker, MeasuresStrokesThatGrowFromWhereEachBegan) {
  ReversalTracker path;
  double way_m = 0.0;
  const auto move = [&](double step_m, int times) {
    for (int k = 0; k < times; ++k)
      way_m = path.step(step_m, 0.01, 1e-5).way_m;
    return way_m;
  };
  for (int amplitude = 1; amplitude < 60; ++amplitude) {  // 0.1 mm more each time, to either side of where it began
    move(amplitude % 2 == 0 ? -1e-4 : 1e-4, 2 * amplitude - 1);
    EXPECT_NEAR(way_m, 1e-4 * (2 * amplitude - 1), 1e-9) << amplitude;
  }
}

}  // namespace
}  // namespace knee_robot::dynamics
