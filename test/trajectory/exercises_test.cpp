#include "knee_robot/trajectory/exercises.h"

#include <gtest/gtest.h>

#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "test/refusal.h"
#include "test/trajectory/robots.h"

namespace knee_robot::trajectory {
namespace {

/// The limits of testRobot (wide: 0.5 to 1.0 m, 90 deg) are generous enough for these.
TEST(Exercises, HipFlexionRaisesThePlatformByItsAmplitudeAtItsSpeedAndReturns) {
  const ExercisePlan plan = planExercise(exerciseNamed("hip_flexion"), testRobot());
  ASSERT_TRUE(plan.check.ok());
  EXPECT_EQ(plan.amplitude, 0.2);
  const Points& poses = plan.check.poses;
  EXPECT_NEAR(poses.col(1).maxCoeff() - plan.start[1], 0.2, 1e-7);
  EXPECT_NEAR(poses.col(1).minCoeff() - plan.start[1], 0.0, 1e-7);
  EXPECT_LE((poses.row(poses.rows() - 1).transpose() - plan.start).cwiseAbs().maxCoeff(), 1e-8);
  const Eigen::VectorXd speed =
      (poses.col(1).tail(poses.rows() - 1) - poses.col(1).head(poses.rows() - 1)) / kStreamPeriod;
  EXPECT_NEAR(speed.maxCoeff(), 0.020, 1e-6);
  for (const int other : {0, 2, 3}) {
    EXPECT_LE((poses.col(other).array() - plan.start[other]).abs().maxCoeff(), 1e-7);
  }
}

TEST(Exercises, KneeFlexionGoesFromZeroTo200AndToMinus110Millimetres) {
  ExerciseOptions options;
  options.space = Space::Platform;
  mechanism::Robot robot = testRobot();
  const ExercisePlan plan = planExercise(exerciseNamed("knee_flexion"), robot, options);
  EXPECT_EQ(plan.reference.space, Space::Platform);
  EXPECT_EQ(plan.start[0], 0.0);
  EXPECT_NEAR(plan.reference.points.col(0).maxCoeff(), 0.2, 1e-9);
  EXPECT_NEAR(plan.reference.points.col(0).minCoeff(), -0.11, 1e-9);
}

TEST(Exercises, EveryExerciseOnEveryRobotIsPlannedOrRefusedWithTheLimitAndWhatFits) {
  for (const char* robot_name : {"A", "B", "final", "starting"}) {
    const mechanism::Robot robot = configuredRobot(robot_name);
    for (const Exercise& exercise : exercises()) {
      const std::string what = exercise.name + " on " + robot_name;
      try {
        const ExercisePlan plan = planExercise(exercise, robot);
        std::printf("%s: planned, start %.3f %.3f %.3f %.3f\n", what.c_str(), plan.start[0], plan.start[1],
                    plan.start[2], plan.start[3]);
        EXPECT_TRUE(plan.check.ok());
        EXPECT_TRUE(checkReference(parseReference(formatReference(plan.reference), what), robot).ok()) << what;
        EXPECT_EQ(plan.amplitude, exercise.amplitude);
      } catch (const Refusal& refusal) {
        const std::string sentence = refusal.what();
        std::printf("%s: refused: %s\n", what.c_str(), sentence.c_str());
        EXPECT_TRUE(sentence.find("limit") != std::string::npos || sentence.find("singular") != std::string::npos)
            << sentence;
        ExerciseOptions options;
        options.scale_to_fit = true;
        if (sentence.find("fits") == std::string::npos) continue;
        const ExercisePlan scaled = planExercise(exercise, robot, options);
        EXPECT_TRUE(scaled.check.ok()) << what;
        EXPECT_TRUE(scaled.amplitude < exercise.amplitude || scaled.speed_share < 1.0) << what;
        EXPECT_FALSE(scaled.notes.empty()) << what;
        // What the refusal suggests is then planned when it is asked for.
        options.scale_to_fit = false;
        options.amplitude = scaled.amplitude;
        options.start = scaled.start;
        options.speed *= scaled.speed_share;
        options.turning_speed *= scaled.speed_share;
        EXPECT_EQ(planExercise(exercise, robot, options).amplitude, scaled.amplitude);
      }
    }
  }
}

TEST(Exercises, AnkleFlexionOfThirtyDegreesIsNearlySingularAtSeventyCentimetresInTheFinalGeometry) {
  mechanism::Robot robot = testRobot();
  robot.singularity_condition_max = 60.0;
  ExerciseOptions options;
  options.start = mechanism::Pose(0.0, 0.7, 0.0, 0.0);
  try {
    planExercise(exerciseNamed("ankle_flexion"), robot, options);
    FAIL() << "theta = -30 deg has a condition number of 690";
  } catch (const Refusal& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("singularity margin"), std::string::npos) << refusal.what();
    EXPECT_NE(std::string(refusal.what()).find("deg fits from this start"), std::string::npos) << refusal.what();
  }
}

TEST(Exercises, RepetitionsAndPausesTakeTheirTime) {
  ExerciseOptions options;
  options.repetitions = 3;
  options.pause_s = 2.0;
  const Exercise& exercise = exerciseNamed("knee_rotation");
  const mechanism::Robot robot = configuredRobot("B");
  const ExercisePlan three = planExercise(exercise, robot, options);
  options.repetitions = 1;
  const ExercisePlan one = planExercise(exercise, robot, options);
  // Three strokes a repetition with a pause between any two, half a second at both ends.
  const double moving = (one.reference.points.rows() - 1) * kStreamPeriod - 2 * 2.0 - 2 * 0.5;
  EXPECT_NEAR((three.reference.points.rows() - 1) * kStreamPeriod, 3 * moving + 8 * 2.0 + 2 * 0.5, 1e-9);
}

TEST(Exercises, RefusesASpeedThatAnActuatorCannotFollowAndSaysWhichOneItCan) {
  mechanism::Robot robot = testRobot();
  for (mechanism::Actuator& actuator : robot.actuators)
    actuator.velocity_max_m_per_s = 0.015;
  const Exercise& exercise = exerciseNamed("hip_flexion");
  EXPECT_THROW(planExercise(exercise, robot), Refusal);
  ExerciseOptions options;
  options.scale_to_fit = true;
  const ExercisePlan plan = planExercise(exercise, robot, options);
  EXPECT_TRUE(plan.check.ok());
  EXPECT_LT(plan.speed_share, 0.8);
  EXPECT_GT(plan.speed_share, 0.6);
}

TEST(Exercises, RefusesWhatTakesLongerThanAReferenceMayLastBeforeItTakesMemory) {
  for (const double slow : {1e-6, 1e-9, 1e-300}) {
    ExerciseOptions options;
    options.speed = options.turning_speed = slow;
    for (const char* name : {"hip_flexion", "knee_rotation"}) {
      const std::string why = refusalOf([&] { planExercise(exerciseNamed(name), configuredRobot("B"), options); });
      EXPECT_NE(why.find("longer than the 10000 s that a reference may last"), std::string::npos) << slow << why;
    }
  }
}

TEST(Exercises, RefusesUnknownNamesImpossibleOptionsAndABench) {
  EXPECT_THROW(exerciseNamed("dance"), InputError);
  const Exercise& exercise = exerciseNamed("hip_flexion");
  ExerciseOptions options;
  options.amplitude = -0.1;
  EXPECT_THROW(planExercise(exercise, testRobot(), options), InputError);
  options = {};
  options.speed = 0.0;
  EXPECT_THROW(planExercise(exercise, testRobot(), options), InputError);
  options = {};
  options.repetitions = 0;
  EXPECT_THROW(planExercise(exercise, testRobot(), options), InputError);
  options = {};
  options.start = mechanism::Pose(0.0, 0.2, 0.0, 0.0);
  EXPECT_THROW(planExercise(exercise, testRobot(), options), Refusal);
  EXPECT_THROW(planExercise(exercise, testBench(4)), InputError);
}

TEST(Exercises, KeepsTheSpeedOfTurnsInDegreesPerSecond) {
  const ExercisePlan plan = planExercise(exerciseNamed("knee_rotation"), configuredRobot("B"));
  const Points& poses = plan.check.poses;
  const Eigen::VectorXd speed =
      (poses.col(3).tail(poses.rows() - 1) - poses.col(3).head(poses.rows() - 1)) / kStreamPeriod;
  EXPECT_NEAR(speed.maxCoeff() / kDegree, 2.0, 1e-3);
  EXPECT_NEAR(poses.col(3).maxCoeff() / kDegree, 15.0, 1e-5);
  EXPECT_NEAR(poses.col(3).minCoeff() / kDegree, -15.0, 1e-5);
}

}  // namespace
}  // namespace knee_robot::trajectory
