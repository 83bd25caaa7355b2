// Excitation of an open chain: within every joint's limits, better than random motion, and beside what was already
// recorded.

#include "knee_robot/excitation/chain_excitation.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace knee_robot::excitation
