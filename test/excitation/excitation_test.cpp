#include "knee_robot/excitation/excitation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/inverse_dynamics.h"
#include "knee_robot/dynamics/robot_inertia.h"
#include "test/excitation/moderate_robot.h"
#include "test/trajectory/robots.h"

namespace knee_robot::excitation {
namespace {

/// Small enough for a test, large enough to improve.
ExcitationOptions quick(unsigned seed) {
  ExcitationOptions options;
  options.seed = seed;
  options.candidates = 6;
  options.starts = 2;
  options.iterations = 12;
  options.seconds_budget = 1e6;
  return options;
}

/// What several tests look at: planned once.
const ExcitationPlan& finalPlan() {
  static const ExcitationPlan plan = planExcitation(trajectory::configuredRobot("final"), quick(1));
  return plan;
}

double shareOf(const std::vector<LimitUsed>& limits, const std::string& name) {
  double worst = 0.0;
  for (const LimitUsed& limit : limits) {
    if (limit.name.find(name) != std::string::npos) worst = std::max(worst, limit.share);
  }
  return worst;
}

TEST(ExcitationLimits, CountTheForcesOfInverseDynamicsWithFriction) {
  const mechanism::Robot robot = moderateRobot("final");
  FourierSeries series;
  series.shape = {1, 6.0, 2.0, 10.0};
  series.centre = mechanism::legLengths(*robot.mechanism, centreOf(robot));
  series.coefficients = Eigen::Matrix<double, 4, 2>::Zero();
  // At rest only gravity acts; friction of a standing axis is not counted.
  const dynamics::RigidModel model(*robot.mechanism, robot.gravity, dynamics::loadRobotInertia(robot));
  mechanism::Motion still;
  still.pose = centreOf(robot);
  mechanism::Vector4 forces;
  ASSERT_TRUE(dynamics::inverseDynamics(model, still, forces));
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
  mechanism::Robot robot = trajectory::configuredRobot("final");
  const double free_peak = 300.0 * shareOf(finalPlan().limits, "peak force");
  for (mechanism::Actuator& actuator : robot.actuators)
    actuator.force_max_N = 0.9 * free_peak;
  const ExcitationPlan plan = planExcitation(robot, quick(1));
  EXPECT_LE(shareOf(plan.limits, "force"), 1.0);
  EXPECT_GT(shareOf(plan.limits, "peak force"), 0.8);
  for (mechanism::Actuator& actuator : robot.actuators)
    actuator.force_max_N = 10.0;  // less than gravity alone
  ExcitationOptions hopeless = quick(1);
  hopeless.candidates = 2;
  EXPECT_THROW(planExcitation(robot, hopeless), Refusal);
  ExcitationOptions careless = quick(1);
  careless.starts = 1;
  careless.iterations = 2;  // that force limits are let go shows in any series
  careless.force_limits = false;
  EXPECT_GT(shareOf(planExcitation(robot, careless).limits, "peak force"), 1.0);
}

TEST(Excitation, KeepsEveryLimitAtEveryMillisecond) {
  ExcitationOptions options = quick(2);
  options.starts = 1;
  const ExcitationPlan of_b = planExcitation(trajectory::configuredRobot("B"), options);
  for (const ExcitationPlan& plan : {of_b, finalPlan()}) {
    ASSERT_GE(plan.limits.size(), 24u);
    for (const LimitUsed& limit : plan.limits)
      EXPECT_LE(limit.share, 1.0) << limit.name << " at " << limit.time_s << " s";
    EXPECT_GT(std::max(shareOf(plan.limits, "velocity"), shareOf(plan.limits, "condition")), 0.9);
  }
}

TEST(Excitation, StartsAndEndsAtRestAndRepeatsItself) {
  ExcitationOptions options = quick(1);
  options.shape.duration_s = 24.0;
  const ExcitationPlan plan = planExcitation(trajectory::configuredRobot("A"), options);
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
  const ExcitationPlan plan = planExcitation(trajectory::configuredRobot("final"), options);
  EXPECT_GT(plan.gain, 0.05);
  EXPECT_TRUE(plan.check.ok());
}

TEST(Excitation, OfRobotAPlaysWithinModerateLimitsAndFarFromSingularities) {
  const mechanism::Robot robot = trajectory::configuredRobot("A");
  ExcitationOptions options = quick(1);
  options.iterations = 30;
  const ExcitationPlan plan = planExcitation(robot, options);
  std::printf("A: k = %.3g at r = 51, best random %.3g\n", plan.k, plan.random_k);
  EXPECT_EQ(plan.reference.points.rows(), 2001);
  mechanism::Robot strict = robot;
  strict.singularity_condition_max = 60.0;
  for (mechanism::Actuator& actuator : strict.actuators) {
    actuator.velocity_max_m_per_s = 0.1;
    actuator.acceleration_max_m_per_s2 = 1.0;
  }
  const trajectory::ReferenceCheck check = trajectory::checkReference(
      trajectory::parseReference(trajectory::formatReference(plan.reference), "plan"), strict);
  EXPECT_TRUE(check.ok()) << check.violation->sentence;
  // Every actuator moves, there and back, with a good part of the speed that it may have.
  const trajectory::Points steps =
      (check.lengths.bottomRows(2000) - check.lengths.topRows(2000)) / trajectory::kStreamPeriod;
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
  const mechanism::Robot robot = trajectory::configuredRobot("final");
  const ExcitationPlan& plan = finalPlan();
  std::printf("final: k = %.3g at r = 51, best random %.3g\n", plan.k, plan.random_k);
  EXPECT_TRUE(trajectory::checkReference(plan.reference, robot).ok());
  EXPECT_LE(plan.k, plan.random_k);
}

TEST(Excitation, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const mechanism::Robot robot = trajectory::configuredRobot("A");
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
  const ExcitationPlan plan = planExcitation(trajectory::configuredRobot("A"), options);
  EXPECT_EQ(plan.reference.points.rows(), 1001);
  EXPECT_LE((plan.reference.points.col(1) - plan.reference.points.col(2)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Excitation, ReturnsTheBestSoFarWhenItIsInterruptedAtOnce) {
  const std::atomic<bool> interrupted{true};
  ExcitationOptions options = quick(1);
  options.interrupted = &interrupted;
  const ExcitationPlan plan = planExcitation(trajectory::configuredRobot("A"), options);
  EXPECT_TRUE(plan.cut_short);
  EXPECT_TRUE(plan.check.ok());
  EXPECT_EQ(plan.k > 0.0 && std::isfinite(plan.k), true);
}

TEST(Excitation, RefusesImpossibleOptionsABenchAndARobotWithoutRoom) {
  const mechanism::Robot robot = trajectory::configuredRobot("A");
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
  refused([](ExcitationOptions& o) { o.noise_N = mechanism::Vector4(1, 1, 0, 1); });
  refused([](ExcitationOptions& o) { o.friction.coulomb_N = -1.0; });
  EXPECT_THROW(planExcitation(trajectory::testBench(4), quick(1)), InputError);
  ExcitationOptions narrow = quick(1);
  narrow.condition_max = 5.0;  // robot A is nowhere that well conditioned
  EXPECT_THROW(planExcitation(robot, narrow), Refusal);
}

}  // namespace
}  // namespace knee_robot::excitation
