#include "knee_robot/trajectory/excitation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/inverse_dynamics.h"
#include "knee_robot/dynamics/robot_inertia.h"
#include "src/trajectory/excitation_problem.h"
#include "src/trajectory/exercise_fit.h"
#include "test/trajectory/robots.h"

namespace knee_robot {
namespace {

/// Where planExcitation starts from.
Pose centreOf(const Robot& robot) {
  return startThatFitsMost({"excitation", "", false, 0.0, {}, std::nullopt}, robot, 0.0);
}

/// Small enough for a test, large enough to improve.
ExcitationOptions quick(unsigned seed) {
  ExcitationOptions options;
  options.seed = seed;
  options.candidates = 12;
  options.starts = 2;
  options.iterations = 12;
  options.seconds_budget = 1e6;
  return options;
}

Robot moderateRobot(const std::string& name) {
  Robot robot = configuredRobot(name);
  robot.singularity_condition_max = 60.0;
  for (Actuator& actuator : robot.actuators) {
    actuator.velocity_max_m_per_s = 0.1;
    actuator.acceleration_max_m_per_s2 = 1.0;
  }
  return robot;
}

ExcitationTask taskOf(const Robot& robot, int directions) {
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
  const auto costAt = [&](const Vector4& noise) {
    task.noise_N = noise;
    const ExcitationProblem problem(task, centreOf(task.robot));
    ExcitationProblem::Evaluation evaluation;
    EXPECT_TRUE(problem.evaluate(*problem.scaledToLimits(randomVariables(problem, 5), 3.0), 0.0, false, evaluation));
    return evaluation.cost;
  };
  EXPECT_NEAR(costAt(Vector4(1, 1, 1, 8)), costAt(Vector4(3, 3, 3, 24)), 1e-6);
  EXPECT_GT(std::abs(costAt(Vector4(1, 1, 1, 8)) - costAt(Vector4(1, 1, 1, 1))), 1e-3);
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

double shareOf(const std::vector<LimitUsed>& limits, const std::string& name) {
  double worst = 0.0;
  for (const LimitUsed& limit : limits) {
    if (limit.name.find(name) != std::string::npos) worst = std::max(worst, limit.share);
  }
  return worst;
}

TEST(ExcitationLimits, CountTheForcesOfInverseDynamicsWithFriction) {
  const Robot robot = moderateRobot("final");
  FourierSeries series;
  series.shape = {1, 6.0, 2.0, 10.0};
  series.centre = legLengths(*robot.mechanism, centreOf(robot));
  series.coefficients = Eigen::Matrix<double, 4, 2>::Zero();
  // At rest only gravity acts; friction of a standing axis is not counted.
  const RigidModel model(*robot.mechanism, robot.gravity, loadRobotInertia(robot));
  Motion still;
  still.pose = centreOf(robot);
  Vector4 forces;
  ASSERT_TRUE(inverseDynamics(model, still, forces));
  const auto resting = limitsUsed(robot, series, {150.0, 15.0}, 0.1);
  ASSERT_TRUE(resting);
  for (int i = 0; i < 4; ++i) {
    const std::string actuator = "actuator " + std::to_string(i + 1);
    EXPECT_NEAR(shareOf(*resting, "peak force of " + actuator), std::abs(forces[i]) / 300.0, 1e-9);
    EXPECT_NEAR(shareOf(*resting, "rms force of " + actuator), std::abs(forces[i]) / 118.0, 1e-9);
  }
  series.coefficients.col(0).setConstant(0.02);
  const auto smooth = limitsUsed(robot, series, {0.0, 0.0}), rubbing = limitsUsed(robot, series, {150.0, 15.0});
  ASSERT_TRUE(smooth && rubbing);
  const double more =
      300.0 * (shareOf(*rubbing, "peak force of actuator 2") - shareOf(*smooth, "peak force of actuator 2"));
  EXPECT_GT(more, 5.0);
  EXPECT_LT(more, 15.0 + 150.0 * 0.03);
}

TEST(Excitation, KeepsForceLimitsThatBindAndSaysSo) {
  Robot robot = configuredRobot("final");
  const ExcitationPlan free_plan = planExcitation(robot, quick(1));
  const double free_peak = 300.0 * shareOf(free_plan.limits, "peak force");
  for (Actuator& actuator : robot.actuators)
    actuator.force_max_N = 0.9 * free_peak;
  const ExcitationPlan plan = planExcitation(robot, quick(1));
  EXPECT_LE(shareOf(plan.limits, "force"), 1.0);
  EXPECT_GT(shareOf(plan.limits, "peak force"), 0.8);
  for (Actuator& actuator : robot.actuators)
    actuator.force_max_N = 10.0;  // less than gravity alone
  EXPECT_THROW(planExcitation(robot, quick(1)), Refusal);
  ExcitationOptions careless = quick(1);
  careless.force_limits = false;
  EXPECT_GT(shareOf(planExcitation(robot, careless).limits, "peak force"), 1.0);
}

TEST(Excitation, KeepsEveryLimitAtEveryMillisecond) {
  for (const char* name : {"A", "final"}) {
    const ExcitationPlan plan = planExcitation(configuredRobot(name), quick(2));
    ASSERT_GE(plan.limits.size(), 24u);
    for (const LimitUsed& limit : plan.limits)
      EXPECT_LE(limit.share, 1.0) << name << ": " << limit.name << " at " << limit.time_s << " s";
    EXPECT_GT(std::max(shareOf(plan.limits, "velocity"), shareOf(plan.limits, "condition")), 0.9);
  }
}

TEST(Excitation, StartsAndEndsAtRestAndRepeatsItself) {
  ExcitationOptions options = quick(1);
  options.shape.duration_s = 24.0;
  const ExcitationPlan plan = planExcitation(configuredRobot("A"), options);
  const FourierSeries& series = plan.series;
  for (const double time : {0.0, 24.0}) {
    const SeriesPoint end = pointAt(series, seriesBasis(series.shape, time));
    EXPECT_LT((end.value - series.centre).norm() + end.rate.norm() + end.acceleration.norm(), 1e-12);
  }
  EXPECT_DOUBLE_EQ(series.shape.period_s, 20.0);
  const SeriesPoint first = pointAt(series, seriesBasis(series.shape, 2.0)),
                    last = pointAt(series, seriesBasis(series.shape, 22.0));
  EXPECT_LT((first.value - last.value).norm() + (first.rate - last.rate).norm(), 1e-12)
      << "one whole period between the ramps";
}

TEST(Excitation, ByDeterminantImprovesTheDeterminant) {
  ExcitationOptions options = quick(1);
  options.criterion = ExcitationCriterion::Determinant;
  const ExcitationPlan plan = planExcitation(configuredRobot("final"), options);
  EXPECT_GT(plan.gain, 0.05);
  EXPECT_TRUE(plan.check.ok());
}

TEST(Excitation, OfRobotAPlaysWithinModerateLimitsAndFarFromSingularities) {
  const Robot robot = configuredRobot("A");
  ExcitationOptions options = quick(1);
  options.iterations = 40;
  const ExcitationPlan plan = planExcitation(robot, options);
  std::printf("A: k = %.3g at r = 51, best random %.3g\n", plan.k, plan.random_k);
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
    EXPECT_GT(steps.col(i).maxCoeff(), 0.03);
    EXPECT_LT(steps.col(i).minCoeff(), -0.03);
  }
  EXPECT_LT(plan.k, 0.7 * plan.random_k);
  ASSERT_EQ(plan.conditions.size(), 6u);
  for (std::size_t i = 1; i < 6; ++i)
    EXPECT_GE(plan.conditions[i].scaled, plan.conditions[i - 1].scaled);
}

TEST(Excitation, OfTheFinalRobotKeepsItsTighterLimits) {
  const Robot robot = configuredRobot("final");
  const ExcitationPlan plan = planExcitation(robot, quick(1));
  std::printf("final: k = %.3g at r = 51, best random %.3g\n", plan.k, plan.random_k);
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
  refused([](ExcitationOptions& o) { o.noise_N = Vector4(1, 1, 0, 1); });
  refused([](ExcitationOptions& o) { o.friction.coulomb_N = -1.0; });
  EXPECT_THROW(planExcitation(testBench(4), quick(1)), InputError);
  ExcitationOptions narrow = quick(1);
  narrow.condition_max = 5.0;  // robot A is nowhere that well conditioned
  EXPECT_THROW(planExcitation(robot, narrow), Refusal);
}

}  // namespace
}  // namespace knee_robot
