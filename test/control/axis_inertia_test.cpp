// What an actuator has to accelerate: against inverse dynamics and a falling weight, not against itself.
#include "knee_robot/control/axis_inertia.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "test/mechanism/configured_robot.h"

namespace knee_robot::control {
namespace {

struct RobotA {
  mechanism::Robot robot = mechanism::configuredRobot("A");
  dynamics::RobotInertia inertia = dynamics::loadRobotInertia(robot);
  mechanism::Pose pose{0.02, 0.62, 0.05, -0.03};
};

TEST(AxisInertia, IsSymmetricPositiveAndLargerWithTheOtherLegsLocked) {
  const RobotA a;
  const AxisInertia w = axisInertia(a.robot, a.inertia, a.pose, 0.0);
  EXPECT_LT((w.matrix - w.matrix.transpose()).norm(), 1e-9 * w.matrix.norm());
  EXPECT_GT(w.matrix.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.0);
  for (int i = 0; i < 4; ++i)
    EXPECT_GT(w.locked()[i], w.free()[i]);
}

TEST(AxisInertia, OfAPayloadIsItsKineticEnergy) {
  const RobotA a;
  const mechanism::Matrix4 more =
      axisInertia(a.robot, a.inertia, a.pose, 7.0).matrix - axisInertia(a.robot, a.inertia, a.pose, 0.0).matrix;
  // A point mass at the platform's origin moves with Xm and Zm alone.
  const mechanism::Matrix4 inverse = mechanism::lengthJacobian(*a.robot.mechanism, a.pose).inverse();
  mechanism::Matrix4 expected = 7.0 * inverse.topRows<2>().transpose() * inverse.topRows<2>();
  EXPECT_LT((more - expected).norm(), 1e-6 * expected.norm());
}

TEST(AxisInertia, RangeHoldsEveryPoseOfIt) {
  const RobotA a;
  const double condition = mechanism::conditionNumber(*a.robot.mechanism, {0.0, 0.6, 0.0, 0.0});
  const std::vector<mechanism::Pose> poses = posesWithin(a.robot, condition);
  EXPECT_GT(poses.size(), 100u);
  EXPECT_GT(posesWithin(a.robot, 1e9).size(), poses.size());
  const AxisInertiaRange range = axisInertiaRange(a.robot, a.inertia, 0.0, poses);
  EXPECT_EQ(range.poses, static_cast<int>(poses.size()));
  for (const mechanism::Pose& pose : poses) {
    EXPECT_LE(mechanism::conditionNumber(*a.robot.mechanism, pose), condition);
    const AxisInertia one = axisInertia(a.robot, a.inertia, pose, 0.0);
    for (int i = 0; i < 4; ++i) {
      EXPECT_GE(one.free()[i], range.low[i]);
      EXPECT_LE(one.locked()[i], range.high[i]);
    }
  }
}

}  // namespace
}  // namespace knee_robot::control
