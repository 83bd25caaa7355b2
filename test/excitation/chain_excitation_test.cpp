// Excitation of an open chain: within every joint's limits, better than random motion, and beside what was already
// recorded.

#include "knee_robot/excitation/chain_excitation.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "knee_robot/base/errors.h"
#include "test/identification/chain_motion.h"

namespace knee_robot::excitation {
namespace {

ChainExcitationOptions quick(const mechanism::Robot& robot) {
  ChainExcitationOptions options;
  options.shape.harmonics = 4;
  options.shape.duration_s = 12.0;
  options.shape.ramp_s = 1.5;
  options.shape.period_s = 9.0;
  options.candidates = 10;
  options.seconds_budget = 1.0;
  const Eigen::Index rigid = robot.axes() * dynamics::kLinkParameters;
  options.units = Eigen::MatrixXd::Identity(rigid, rigid);
  options.noise = Eigen::VectorXd::Constant(robot.axes(), 0.5);
  return options;
}

TEST(ChainExcitation, KeepsEveryLimitFromRestToRest) {
  const mechanism::Robot robot = identification::testArm();
  const ChainExcitationPlan plan = planChainExcitation(robot, quick(robot));
  ASSERT_EQ(plan.joints.size(), 6u);
  for (const JointUse& use : plan.joints) {
    EXPECT_LE(use.range, 0.9 + 1e-9) << use.name;
    EXPECT_LE(use.velocity, 0.9 + 1e-9) << use.name;
    EXPECT_LE(use.acceleration, 0.9 + 1e-9) << use.name;
    EXPECT_GT(std::max({use.range, use.velocity, use.acceleration}), 0.85) << use.name << " uses what it has";
  }
  EXPECT_LT(plan.velocity.row(0).norm() + plan.velocity.bottomRows(1).norm(), 1e-9);
  EXPECT_GE(plan.information, plan.information_random);
  const Eigen::MatrixXd slope =
      (plan.position.bottomRows(plan.position.rows() - 2) - plan.position.topRows(plan.position.rows() - 2)) /
      (2.0 * plan.period_s);
  EXPECT_LT((slope - plan.velocity.middleRows(1, slope.rows())).cwiseAbs().maxCoeff(), 0.02);
}

TEST(ChainExcitation, CountsWhatWasAlreadyRecorded) {
  const mechanism::Robot robot = identification::testArm();
  ChainExcitationOptions options = quick(robot);
  const ChainExcitationPlan first = planChainExcitation(robot, options);
  const Eigen::MatrixXd rows =
      chainInformation(robot, options, first.position, first.velocity, Eigen::MatrixXd::Zero(first.position.rows(), 6));
  options.known = rows.transpose() * rows;
  const ChainExcitationPlan second = planChainExcitation(robot, options);
  EXPECT_GT(second.decided_known, 10);
  EXPECT_GE(second.decided, second.decided_known);
  EXPECT_GT(second.information, second.information_known);
  EXPECT_GT(second.information, first.information);
}

TEST(ChainExcitation, TheSharesHoldForTheWholeWrittenMotionWithItsRampsAndEnds) {
  const mechanism::Robot robot = identification::testArm();
  ChainExcitationOptions options = quick(robot);
  options.shape.harmonics = 30;  // the highest turns in four of the written rows
  options.shape.duration_s = 1.7;
  options.shape.ramp_s = 0.3;
  const ChainExcitationPlan plan = planChainExcitation(robot, options);
  const double h = plan.period_s;
  const Eigen::Index rows = plan.position.rows();
  ASSERT_EQ(rows, 171);
  for (int i = 0; i < robot.axes(); ++i) {
    const mechanism::Actuator& joint = robot.actuators[static_cast<std::size_t>(i)];
    const double unit = joint.position_per_m();
    double fastest = 0.0, hardest = 0.0;       // mean over a row's interval: never more than the largest
    for (Eigen::Index n = 0; n < rows; ++n) {  // at rest before and afterwards
      const double before = plan.position(std::max<Eigen::Index>(0, n - 1), i), now = plan.position(n, i);
      const double after = plan.position(std::min(rows - 1, n + 1), i);
      fastest = std::max(fastest, std::abs(after - now) / h);
      hardest = std::max(hardest, std::abs(after - 2.0 * now + before) / (h * h));
    }
    const JointUse& use = plan.joints[static_cast<std::size_t>(i)];
    EXPECT_LE(fastest, (use.velocity + 1e-3) * joint.velocity_max_m_per_s * unit) << joint.name;
    EXPECT_LE(hardest, (use.acceleration + 1e-3) * joint.acceleration_max_m_per_s2 * unit) << joint.name;
    EXPECT_LE(std::max({use.range, use.velocity, use.acceleration}), 0.9 + 1e-9) << joint.name;
  }
  EXPECT_LT(plan.velocity.row(0).norm() + plan.velocity.bottomRows(1).norm(), 1e-9);
}

TEST(ChainExcitation, RefusesShapesThatDoNotGoFromRestToRest) {
  const mechanism::Robot robot = identification::testArm();
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const auto refused = [&](double duration_s, double ramp_s, int harmonics) {
    ChainExcitationOptions options = quick(robot);
    options.shape.duration_s = duration_s;
    options.shape.ramp_s = ramp_s;
    options.shape.harmonics = harmonics;
    EXPECT_THROW(planChainExcitation(robot, options), InputError) << duration_s << " " << ramp_s << " " << harmonics;
  };
  for (const double ramp_s : {0.0, -1.0, 100.0, nan, inf})
    refused(12.0, ramp_s, 4);
  for (const double duration_s : {-5.0, 0.05, 1.0, 1e5, 1e9, nan, inf})
    refused(duration_s, 1.5, 4);
  for (const int harmonics : {-1, 0, 31, 100000})
    refused(12.0, 1.5, harmonics);
}

TEST(ChainExcitation, TheTimeLimitCountsTheRandomSeriesToo) {
  const mechanism::Robot robot = identification::testArm();
  ChainExcitationOptions options = quick(robot);
  options.candidates = 100000;
  options.seconds_budget = 0.5;
  const auto start = std::chrono::steady_clock::now();
  const ChainExcitationPlan plan = planChainExcitation(robot, options);
  EXPECT_LT(plan.evaluations, 100000);
  EXPECT_GE(plan.evaluations, 1);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_LT(seconds, 10.0) << "100000 series take minutes";
}

}  // namespace
}  // namespace knee_robot::excitation
