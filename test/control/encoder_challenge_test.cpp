// Questions on suspicion: a healthy axis answers within steps of its encoder and stays where it was, a dead one is
// found while it falls.
#include "knee_robot/control/encoder_challenge.h"

#include <gtest/gtest.h>

#include <cmath>

#include "knee_robot/control/standing_axis.h"
#include "src/control/rest_watch.h"

namespace knee_robot::control {
namespace {

constexpr double kCount_m = 5e-6;

/// A mass with dry friction, held by a loop, under a load.
struct Axis {
  double friction_N = 40.0, load_N = 0.0, mass_kg = 20.0, position_m = 0.0, velocity = 0.0, farthest_m = 0.0;
  void step(double force_N) {
    for (int k = 0; k < 10; ++k) {
      const double drive = force_N + load_N - 60000.0 * position_m - 1500.0 * velocity;
      if (velocity == 0.0 && std::abs(drive) <= friction_N) continue;
      const double direction = velocity != 0.0 ? velocity : drive;
      const double next = velocity + 1e-4 * (drive - std::copysign(friction_N, direction)) / mass_kg;
      velocity = velocity * next < 0.0 ? 0.0 : next;
      position_m += 1e-4 * velocity;
      farthest_m = std::max(farthest_m, std::abs(position_m));
    }
  }
  std::int64_t counts() const { return std::lround(position_m / kCount_m); }
};

EncoderChallenge::Question question() {
  return {60.0, 150.0, 0.0, 0, false};
}

TEST(EncoderChallenge, AHealthyAxisAnswersWithinAFewHundredthsOfAMillimetreAndGoesBack) {
  for (const double friction : {0.0, 15.0, 55.0}) {
    for (const double load : {-0.9, 0.0, 0.9}) {
      Axis axis;
      axis.friction_N = friction;
      axis.load_N = load * friction;
      EncoderChallenge challenge;
      challenge.begin(axis.counts(), question());
      bool alive = false;
      for (int k = 0; k < 100 && (challenge.isActive() || !alive); ++k) {
        const EncoderChallenge::Verdict verdict = challenge.step(0.001, axis.counts());
        ASSERT_NE(verdict, EncoderChallenge::Verdict::Dead) << friction << " N, load " << axis.load_N;
        alive = alive || verdict == EncoderChallenge::Verdict::Alive;
        axis.step(challenge.force_N());
      }
      EXPECT_TRUE(alive);
      EXPECT_LT(axis.farthest_m, 1e-4) << friction << " N, load " << axis.load_N;
    }
  }
}

TEST(EncoderChallenge, AnEncoderWithoutASingleCountIsDeadWithin30Milliseconds) {
  EncoderChallenge challenge;
  challenge.begin(7, question());
  int cycles = 0;
  while (challenge.step(0.001, 7) != EncoderChallenge::Verdict::Dead)
    ASSERT_LT(++cycles, 30);
  EXPECT_FALSE(challenge.isActive());
}

TEST(EncoderChallenge, WithTimeItMovesAnAxisByNoMoreThanTwoStepsAndWhatItSlips) {
  Axis axis;
  EncoderChallenge challenge;
  EncoderChallenge::Question asked = question();
  asked.gentle = true;
  challenge.begin(axis.counts(), asked);
  bool alive = false;
  for (int k = 0; k < 100; ++k) {
    alive = challenge.step(0.001, axis.counts()) == EncoderChallenge::Verdict::Alive || alive;
    axis.step(challenge.force_N());
  }
  EXPECT_TRUE(alive);
  EXPECT_LT(axis.farthest_m, 4 * kCount_m);
}

TEST(EncoderChallenge, AnOpenInputThatDithersIsNoAnswer) {
  EncoderChallenge challenge;
  EncoderChallenge::Question asked = question();
  asked.dithers = 4;
  challenge.begin(0, asked);
  int k = 0;
  while (challenge.step(0.001, 2 * (++k % 3) - 2) != EncoderChallenge::Verdict::Dead)
    ASSERT_LT(k, 100);
}

TEST(EncoderChallenge, ASingleCountIsAskedAgainAndNotCondemnedAtOnce) {
  EncoderChallenge challenge;
  challenge.begin(0, question());
  for (int k = 0; k < 40; ++k)
    ASSERT_EQ(challenge.step(0.001, k > 5 ? 1 : 0), EncoderChallenge::Verdict::None);
  EXPECT_EQ(challenge.step(0.001, 2), EncoderChallenge::Verdict::Alive);
}

TEST(StandingAxis, CountsUpAndDownAreDitherAndCountsOneWayAreNot) {
  StandingAxis dithers, moves;
  for (int k = 0; k < 40; ++k) {
    dithers.step(0.001, k % 2, 0.0, 0.0);
    moves.step(0.001, k / 10, 0.0, 0.0);
  }
  EXPECT_EQ(dithers.dithers(), 1);
  EXPECT_EQ(moves.dithers(), 0);
}

TEST(StandingAxis, ForceThatGrowsWithoutACountIsSeenAndMovingOnForgetsIt) {
  StandingAxis axis;
  for (int k = 0; k < 100; ++k)
    axis.step(0.001, 3, 0.0, 0.1 * k);
  EXPECT_NEAR(axis.changed_N(), 9.9, 0.11);
  axis.step(0.001, 3 + StandingAxis::kDither + 1, 0.0, 10.0);
  EXPECT_LT(axis.changed_N(), 0.2);
}

TEST(StandingAxis, AnAxisThatMovesOnNeedsNoQuestionAndOneThatDithersDoes) {
  StandingAxis moves, dithers;
  for (int k = 0; k < 40; ++k) {
    moves.step(0.001, k / 3, 0.0, 0.0);
    dithers.step(0.001, 6 * (k % 2), 0.0, 0.0);
  }
  EXPECT_TRUE(moves.counts());
  EXPECT_FALSE(dithers.counts());
}

TEST(StandingAxis, IsOverdueWhenTheReferenceGoesOnWithoutACountAndNotWhenItFollows) {
  constexpr double kCount_m = 2e-5;
  StandingAxis stands, follows, rests;
  bool overdue = false, followed_overdue = false;
  for (int k = 0; k <= 7; ++k)
    stands.step(0.001, k, 2e-5 * (k - 8), 0.0);
  for (int k = 0; k < 60; ++k) {
    const double reference = 2e-5 * k;  // a count each millisecond
    stands.step(0.001, 7, reference, 0.0);
    follows.step(0.001, std::max(0, k - 6), reference, 0.0);  // some counts behind
    rests.step(0.001, 7, 0.0, 0.0);
    overdue = overdue || (stands.isOverdue(kCount_m) && k < 15);
    followed_overdue = followed_overdue || follows.isOverdue(kCount_m);
  }
  EXPECT_TRUE(overdue) << "within 15 ms";
  EXPECT_FALSE(followed_overdue);
  EXPECT_FALSE(rests.isOverdue(kCount_m));
}

TEST(StandingAxis, LearnsWhatAHealthyAxisTakesAtATurningPointAndForgetsIt) {
  StandingAxis axis;
  std::int64_t counts = 0;
  for (int k = 0; k < 100; ++k)
    axis.step(0.001, counts, 0.0, 0.4 * k);  // sticks up to 40 N
  axis.step(0.001, counts += 6, 0.0, 40.0);
  EXPECT_NEAR(axis.usual_N(), 40.0, 0.5);
  axis.endures(55.0);
  EXPECT_NEAR(axis.usual_N(), 55.0, 0.1);
  for (int k = 0; k < 600'000; ++k)
    axis.step(0.001, k, 0.0, 0.0);
  EXPECT_LT(axis.usual_N(), 0.5);
}

TEST(StandingAxis, DoesNotLearnFromWhatAPulseMoves) {
  StandingAxis axis;
  for (int k = 0; k < 100; ++k)
    axis.step(0.001, 0, 0.0, 0.4 * k);
  axis.step(0.001, 6, 0.0, 40.0, true);
  EXPECT_EQ(axis.usual_N(), 0.0);
}

TEST(StandingAxis, IsNotOverdueWhereTheReferenceHasTurned) {
  constexpr double kCount_m = 2e-5;
  StandingAxis turns, dies;
  for (int k = 0; k < 50; ++k) {
    turns.step(0.001, k, kCount_m * k, 0.0);
    dies.step(0.001, k, kCount_m * k, 0.0);
  }
  for (int k = 0; k < 50; ++k) {
    turns.step(0.001, 49, kCount_m * (49 - k), 0.0);
    dies.step(0.001, 49, kCount_m * (49 + k), 0.0);
  }
  EXPECT_FALSE(turns.isOverdue(kCount_m));
  EXPECT_TRUE(dies.isOverdue(kCount_m));
}

struct RestingRobot {
  RestWatch watch;
  RestWatch::Axes error_m{}, count_m{2e-5, 2e-5, 2e-5, 2.3e-6};
  bool disturbed(double seconds, bool rests = true, bool pulses = false) {
    bool any = false;
    for (int k = 0; k < static_cast<int>(1000 * seconds); ++k)
      any = watch.step(rests, pulses, 0.001, error_m, count_m) || any;
    return any;
  }
};

TEST(RestWatch, ARobotThatStandsOrSlipsTowardsItsReferenceIsNotDisturbed) {
  RestingRobot robot;
  robot.error_m[1] = 6e-5;
  EXPECT_FALSE(robot.disturbed(2.0));
  robot.error_m[1] = 0.0;
  EXPECT_FALSE(robot.disturbed(2.0)) << "a slip of three counts to the reference";
}

TEST(RestWatch, TwoCountsAwayFromTheReferenceAreADisturbanceOnlyAtRest) {
  RestingRobot robot;
  robot.disturbed(1.0);
  robot.error_m[2] = 4e-5;
  EXPECT_TRUE(robot.disturbed(0.001));
  RestingRobot moving;
  moving.disturbed(1.0, false);
  moving.error_m[2] = 4e-5;
  EXPECT_FALSE(moving.disturbed(0.001, false));
}

TEST(RestWatch, WhatATestPulseMovesIsNoDisturbanceButAPushMeanwhileIs) {
  RestingRobot robot;
  robot.disturbed(1.0);
  robot.error_m[0] = 1e-4;
  EXPECT_FALSE(robot.disturbed(0.03, true, true));
  robot.error_m[0] = 4e-4;
  EXPECT_TRUE(robot.disturbed(0.01, true, true));
}

}  // namespace
}  // namespace knee_robot::control
