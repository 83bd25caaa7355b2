#include "src/excitation/excitation_problem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "test/excitation/moderate_robot.h"
#include "test/trajectory/robots.h"

namespace knee_robot::excitation {
namespace {

ExcitationTask taskOf(const mechanism::Robot& robot, int directions) {
  ExcitationTask task;
  task.robot = robot;
  task.shape = {3, 6.0, 2.0, 10.0};
  task.directions = directions;
  task.load = expectedLoad(robot, {});
  task.width = {5e-3, 2e-2};
  task.noise_N << 1.0, 1.0, 1.0, 8.0;
  return task;
}

Eigen::VectorXd randomVariables(const ExcitationProblem& problem, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 0.2);
  Eigen::VectorXd variables(problem.variables());
  for (double& value : variables)
    value = normal(random);
  return variables;
}

/// Exact gradients of the criterion and of every limit beside differences along random directions.
void expectExactGradients(const ExcitationProblem& problem, double exponent) {
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const std::optional<Eigen::VectorXd> fitting = problem.scaledToLimits(randomVariables(problem, seed), 3.0);
    ASSERT_TRUE(fitting);
    const Eigen::VectorXd& at = *fitting;
    ExcitationProblem::Evaluation exact, ahead, behind;
    ASSERT_TRUE(problem.evaluate(at, exponent, true, exact));
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (int round = 0; round < 4; ++round) {
      Eigen::VectorXd direction(problem.variables());
      for (double& value : direction)
        value = normal(random);
      direction.normalize();
      const double h = 1e-5;
      ASSERT_TRUE(problem.evaluate(at + h * direction, exponent, false, ahead));
      ASSERT_TRUE(problem.evaluate(at - h * direction, exponent, false, behind));
      const double slope = (ahead.cost - behind.cost) / (2 * h);
      EXPECT_NEAR(exact.cost_gradient.dot(direction), slope, 1e-5 * std::max(1.0, std::abs(slope)));
      const Eigen::VectorXd limit_slopes = (ahead.limits - behind.limits) / (2 * h);
      const Eigen::VectorXd found = exact.limit_gradients.transpose() * direction;
      int off = 0;  // where the largest use of a stretch changes its instant, or a quantity its sign, there is a kink
      for (Eigen::Index k = 0; k < found.size(); ++k)
        off += std::abs(found[k] - limit_slopes[k]) > 1e-5 * std::max(1.0, std::abs(limit_slopes[k])) ? 1 : 0;
      EXPECT_LE(off, problem.limits() / 200);
    }
  }
}

TEST(ExcitationProblem, GradientsOfLogKAndOfEveryLimitAreExact) {
  for (const char* name : {"A", "final"})
    expectExactGradients(ExcitationProblem(taskOf(moderateRobot(name), 40), centreOf(moderateRobot(name))), 0.0);
}

TEST(ExcitationProblem, GradientOfTheSmoothedLogKIsExact) {
  expectExactGradients(ExcitationProblem(taskOf(moderateRobot("B"), 40), centreOf(moderateRobot("B"))), 8.0);
}

TEST(ExcitationProblem, GradientOfTheDeterminantIsExact) {
  ExcitationTask task = taskOf(moderateRobot("A"), 40);
  task.criterion = ExcitationCriterion::Determinant;
  ExcitationProblem problem(task, centreOf(task.robot));
  const Eigen::VectorXd some = *problem.scaledToLimits(randomVariables(problem, 9), 3.0);
  problem.setFixedScale(columnScales(*problem.observations(problem.series(some))));
  expectExactGradients(problem, 0.0);
}

TEST(ExcitationProblem, QuickConditionAgreesWithTheSingularValues) {
  const ExcitationProblem problem(taskOf(moderateRobot("A"), 40), centreOf(moderateRobot("A")));
  const Eigen::VectorXd variables = *problem.scaledToLimits(randomVariables(problem, 5), 3.0);
  const auto conditions = conditionsOf(*problem.observations(problem.series(variables)), {20, 40, 112});
  ExcitationProblem::Evaluation evaluation;
  ASSERT_TRUE(problem.evaluate(variables, 0.0, false, evaluation));
  EXPECT_NEAR(std::exp(evaluation.cost), conditions[1].scaled, 1e-4 * conditions[1].scaled);
  EXPECT_LT(conditions[0].scaled, conditions[1].scaled);
  EXPECT_TRUE(std::isinf(conditions[2].scaled)) << "112 columns are not independent";
  const double exact = evaluation.cost;
  double before = std::numeric_limits<double>::infinity();
  for (const double exponent : {1.0, 4.0, 16.0, 64.0}) {
    ASSERT_TRUE(problem.evaluate(variables, exponent, false, evaluation));
    EXPECT_GE(evaluation.cost, exact) << "the smoothed one bounds log k from above";
    EXPECT_LE(evaluation.cost, before) << "and comes nearer";
    before = evaluation.cost;
  }
  EXPECT_NEAR(before, exact, 0.05);
}

TEST(ExcitationProblem, NoiseOfAnActuatorMattersAsARatioOnly) {
  ExcitationTask task = taskOf(moderateRobot("A"), 40);
  const auto costAt = [&](const mechanism::Vector4& noise) {
    task.noise_N = noise;
    const ExcitationProblem problem(task, centreOf(task.robot));
    ExcitationProblem::Evaluation evaluation;
    EXPECT_TRUE(problem.evaluate(*problem.scaledToLimits(randomVariables(problem, 5), 3.0), 0.0, false, evaluation));
    return evaluation.cost;
  };
  EXPECT_NEAR(costAt(mechanism::Vector4(1, 1, 1, 8)), costAt(mechanism::Vector4(3, 3, 3, 24)), 1e-6);
  EXPECT_GT(std::abs(costAt(mechanism::Vector4(1, 1, 1, 8)) - costAt(mechanism::Vector4(1, 1, 1, 1))), 1e-3);
}

TEST(ExcitationProblem, ScalingToTheLimitsUsesThemFully) {
  const ExcitationProblem problem(taskOf(moderateRobot("A"), 40), centreOf(moderateRobot("A")));
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const std::optional<Eigen::VectorXd> variables = problem.scaledToLimits(randomVariables(problem, seed), 100.0);
    ASSERT_TRUE(variables);
    const double use = problem.worstUse(*variables, 1e9);
    EXPECT_LE(use, 1.0);
    EXPECT_GE(use, 0.9);
  }
}

}  // namespace
}  // namespace knee_robot::excitation
