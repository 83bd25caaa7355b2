#include "knee_robot/trajectory/excitation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "knee_robot/base/errors.h"
#include "src/trajectory/excitation_problem.h"
#include "test/trajectory/robots.h"

namespace knee_robot {
namespace {

const Pose kCentre(0.0, 0.65, 0.15, -0.10);

/// Small enough for a test, large enough to improve.
ExcitationOptions quick(unsigned seed) {
  ExcitationOptions options;
  options.seed = seed;
  options.candidates = 12;
  options.starts = 2;
  options.iterations = 8;
  options.seconds_budget = 1e6;
  return options;
}

ExcitationProblem problemOf(const Robot& robot, int directions) {
  SeriesShape shape{3, 6.0, 2.0, 10.0};
  return {robot, shape, directions, false, kCentre};
}

Robot moderateRobot() {
  Robot robot = configuredRobot("A");
  robot.singularity_condition_max = 60.0;
  for (Actuator& actuator : robot.actuators)
    actuator.velocity_max_m_per_s = 0.1;
  return robot;
}

Eigen::VectorXd randomVariables(const ExcitationProblem& problem, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 0.2);
  Eigen::VectorXd variables(problem.variables());
  for (double& value : variables)
    value = normal(random);
  return variables;
}

TEST(ExcitationProblem, GradientAgreesWithDifferencesOfTheCost) {
  const ExcitationProblem problem = problemOf(moderateRobot(), 40);
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const std::optional<Eigen::VectorXd> variables = problem.scaledToLimits(randomVariables(problem, seed), 3.0);
    ASSERT_TRUE(variables);
    // A little beyond the limits, so that the penalty takes part.
    const Eigen::VectorXd at = 1.1 * *variables;
    Eigen::VectorXd gradient;
    const std::optional<double> cost = problem.cost(at, 30.0, &gradient);
    ASSERT_TRUE(cost);
    std::mt19937 random(seed);
    for (int round = 0; round < 5; ++round) {
      Eigen::VectorXd direction(problem.variables());
      std::normal_distribution<double> normal;
      for (double& value : direction)
        value = normal(random);
      direction.normalize();
      const double h = 1e-5;
      const double slope =
          (*problem.cost(at + h * direction, 30.0, nullptr) - *problem.cost(at - h * direction, 30.0, nullptr)) /
          (2 * h);
      EXPECT_NEAR(gradient.dot(direction), slope, 1e-4 * std::max(1.0, std::abs(slope)));
    }
  }
}

TEST(ExcitationProblem, QuickConditionAgreesWithTheSingularValues) {
  const ExcitationProblem problem = problemOf(moderateRobot(), 40);
  const Eigen::VectorXd variables = *problem.scaledToLimits(randomVariables(problem, 5), 3.0);
  const auto conditions = conditionsOf(*problem.observations(problem.series(variables)), {20, 40, 112});
  EXPECT_NEAR(std::exp(*problem.cost(variables, 0.0, nullptr)), conditions[1].scaled, 1e-4 * conditions[1].scaled);
  EXPECT_LT(conditions[0].scaled, conditions[1].scaled);
  EXPECT_TRUE(std::isinf(conditions[2].scaled)) << "112 columns are not independent";
}

TEST(ExcitationProblem, ScalingToTheLimitsUsesThemFully) {
  const ExcitationProblem problem = problemOf(moderateRobot(), 40);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const std::optional<Eigen::VectorXd> variables = problem.scaledToLimits(randomVariables(problem, seed), 100.0);
    ASSERT_TRUE(variables);
    const double use = problem.worstUse(problem.series(*variables));
    EXPECT_LE(use, 1.0);
    EXPECT_GE(use, 0.9);
  }
}

TEST(Excitation, OfRobotAPlaysWithinModerateLimitsAndFarFromSingularities) {
  const Robot robot = configuredRobot("A");
  const ExcitationPlan plan = planExcitation(robot, quick(1));
  std::printf("A: k = %.3g at r = 56, best random %.3g\n", plan.k, plan.random_k);
  EXPECT_EQ(plan.reference.points.rows(), 2001);
  Robot strict = robot;
  strict.singularity_condition_max = 60.0;
  for (Actuator& actuator : strict.actuators) {
    actuator.velocity_max_m_per_s = 0.1;
    actuator.acceleration_max_m_per_s2 = 1.0;
  }
  const ReferenceCheck check = checkReference(parseReference(formatReference(plan.reference), "plan"), strict);
  EXPECT_TRUE(check.ok()) << check.violation->sentence;
  // Every actuator moves, there and back, with a good part of the speed that it may have.
  const Points steps = (check.lengths.bottomRows(2000) - check.lengths.topRows(2000)) / kStreamPeriod;
  for (int i = 0; i < 4; ++i) {
    EXPECT_GT(steps.col(i).maxCoeff(), 0.04);
    EXPECT_LT(steps.col(i).minCoeff(), -0.04);
  }
  EXPECT_LT(plan.k, 0.7 * plan.random_k);
  ASSERT_EQ(plan.conditions.size(), 6u);
  for (std::size_t i = 1; i < 6; ++i)
    EXPECT_GE(plan.conditions[i].scaled, plan.conditions[i - 1].scaled);
}

TEST(Excitation, OfTheFinalRobotKeepsItsTighterLimits) {
  const Robot robot = configuredRobot("final");
  const ExcitationPlan plan = planExcitation(robot, quick(1));
  std::printf("final: k = %.3g at r = 56, best random %.3g\n", plan.k, plan.random_k);
  EXPECT_TRUE(checkReference(plan.reference, robot).ok());
  EXPECT_LE(plan.k, plan.random_k);
}

TEST(Excitation, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const Robot robot = configuredRobot("A");
  ExcitationOptions one = quick(1);
  one.candidates = 4;
  one.starts = 1;
  one.iterations = 2;
  ExcitationOptions two = one;
  two.seed = 2;
  const ExcitationPlan first = planExcitation(robot, one), again = planExcitation(robot, one),
                       other = planExcitation(robot, two);
  EXPECT_EQ(first.reference.points, again.reference.points);
  EXPECT_GT((first.reference.points - other.reference.points).cwiseAbs().maxCoeff(), 0.02);
}

TEST(Excitation, WithTwinLegsMovesLegsTwoAndThreeIdentically) {
  ExcitationOptions options = quick(3);
  options.shape.duration_s = 10.0;
  options.twin_legs = true;
  options.iterations = 2;
  const ExcitationPlan plan = planExcitation(configuredRobot("A"), options);
  EXPECT_EQ(plan.reference.points.rows(), 1001);
  EXPECT_LE((plan.reference.points.col(1) - plan.reference.points.col(2)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Excitation, ReturnsTheBestSoFarWhenItIsInterruptedAtOnce) {
  const std::atomic<bool> interrupted{true};
  ExcitationOptions options = quick(1);
  options.interrupted = &interrupted;
  const ExcitationPlan plan = planExcitation(configuredRobot("A"), options);
  EXPECT_TRUE(plan.cut_short);
  EXPECT_TRUE(plan.check.ok());
  EXPECT_EQ(plan.k > 0.0 && std::isfinite(plan.k), true);
}

TEST(Excitation, RefusesImpossibleOptionsABenchAndARobotWithoutRoom) {
  const Robot robot = configuredRobot("A");
  const auto refused = [&](void (*change)(ExcitationOptions&)) {
    ExcitationOptions options = quick(1);
    change(options);
    EXPECT_THROW(planExcitation(robot, options), InputError);
  };
  refused([](ExcitationOptions& o) { o.shape.duration_s = 3.0; });
  refused([](ExcitationOptions& o) { o.shape.harmonics = 0; });
  refused([](ExcitationOptions& o) { o.velocity_max = 0.0; });
  refused([](ExcitationOptions& o) { o.directions = 74; });
  refused([](ExcitationOptions& o) { o.condition_max = 0.5; });
  EXPECT_THROW(planExcitation(testBench(4), quick(1)), InputError);
  ExcitationOptions narrow = quick(1);
  narrow.condition_max = 5.0;  // robot A is nowhere that well conditioned
  EXPECT_THROW(planExcitation(robot, narrow), Refusal);
}

}  // namespace
}  // namespace knee_robot
