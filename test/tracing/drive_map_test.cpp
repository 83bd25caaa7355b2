// What a drive loses: another force than its command says, by a curve over the force that the motion needs.
#include <algorithm>
#include <cmath>

#include "knee_robot/mechanism/decompositions.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

class DriveMap : public SearchedMachine {
 protected:
  const Candidate& map(const std::string& depends_on) {
    maps_ = mapCandidates(data_.inputs);
    return **std::find_if(maps_.begin(), maps_.end(),
                          [&](const auto& c) { return c->dependsOn(kActuator) == depends_on; });
  }
  const EffectInput& input() const { return data_.inputs.front(); }
  std::vector<double> knots(const Candidate& c) const { return c.shapes(input(), kActuator).front(); }
  Eigen::MatrixXd columns(const Candidate& c) const { return c.columns(input(), kActuator, knots(c)); }
  double left(const Candidate& c, const Eigen::VectorXd& force) const {
    const Eigen::MatrixXd all = columns(c);
    return (force - all * Eigen::VectorXd(all.colPivHouseholderQr().solve(force))).norm() / force.norm();
  }
  /// Of a bridge whose dead time takes this force by its sign.
  Eigen::VectorXd deadTime(double lost_N) const {
    return lost_N * (input().needed_N.col(kActuator).array() / 2.0).tanh();
  }

  CandidateList maps_;
};

TEST_F(DriveMap, FollowsTheDeadTimeOfABridgeWhichLoadsAndVelocitiesDoNot) {
  ASSERT_LT(input().needed_N.col(kActuator).minCoeff(), -10.0);
  ASSERT_GT(input().needed_N.col(kActuator).maxCoeff(), 10.0);
  const Eigen::VectorXd lost = deadTime(6.0);
  EXPECT_LT(left(map("needed_force_2_N"), lost), 0.1);
  EXPECT_GT(left(map("load_2_N"), lost), 0.2);
  EXPECT_GT(left(map("velocity_2_m_per_s"), lost), 0.2);
}

TEST_F(DriveMap, LooksAtTheForceThatTheMotionNeedsAndNotAtItself) {
  const Candidate& drive = map("needed_force_2_N");
  const Eigen::VectorXd lost =
      columns(drive) * Eigen::VectorXd(columns(drive).colPivHouseholderQr().solve(deadTime(6.0)));
  const Hypothesis hypothesis = {{&drive, kActuator}, knots(drive)};
  const Eigen::MatrixXd needed = input().needed_N;
  SurrogateModel model = {
      base_.parameters, {hypothesis}, {Eigen::VectorXd(columns(drive).colPivHouseholderQr().solve(deadTime(6.0)))}};
  const SurrogateEffects settled = settleForces(data_.inputs.front(), base_.columns, base_.parameters, model);
  EXPECT_LT((input().needed_N - needed).norm(), 1e-9 * needed.norm());
  EXPECT_LT((settled.load_N.col(kActuator) - lost).norm(), 1e-9 * lost.norm());
  EXPECT_LT((input().force_N.col(kActuator) - needed.col(kActuator) - lost).norm(), 1e-9 * needed.norm());
}

TEST_F(DriveMap, HasKnotsWhereTheForceChangesItsSignAndBeyondNothingThatWasNeeded) {
  const std::vector<double> at = knots(map("needed_force_2_N"));
  EXPECT_TRUE(std::is_sorted(at.begin(), at.end()));
  EXPECT_LT(at[4] - at[3], 0.05 * (at[7] - at[0]));
  EXPECT_GE(at.front(), std::min(data_.inputs[0].needed_N.col(kActuator).minCoeff(),
                                 data_.inputs[1].needed_N.col(kActuator).minCoeff()));
}

TEST_F(DriveMap, SeesCrosstalkOfAnotherDrive) {
  const Eigen::VectorXd crosstalk = 0.15 * input().needed_N.col(3);
  EXPECT_LT(left(map("needed_force_4_N"), crosstalk), 0.02);
  EXPECT_GT(left(map("needed_force_2_N"), crosstalk), 0.1);
  EXPECT_FALSE(map("needed_force_4_N").ofDrive()) << "it is no loss of its own drive";
}

TEST_F(DriveMap, ComesBackFromAModelByItsName) {
  const Candidate& drive = map("needed_force_2_N");
  const auto again = mapCandidate(robot_, "needed_force_2_N", kActuator, knots(drive));
  ASSERT_NE(again, nullptr);
  EXPECT_EQ(again->columns(input(), kActuator, knots(drive)), columns(drive));
}

}  // namespace
}  // namespace knee_robot::tracing
