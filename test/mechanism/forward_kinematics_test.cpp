#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "knee_robot/mechanism/pose_follower.h"
#include "test/mechanism/random_poses.h"

namespace knee_robot::mechanism {
namespace {

TEST(ForwardKinematics, ReturnsThePoseThatInverseKinematicsStartedFrom) {
  RandomPoses random(4, 60.0);
  for (const Mechanism& m : {finalMechanism(), startingMechanism(), mechanismB()}) {
    for (int k = 0; k < 3000; ++k) {
      const Pose pose = random.pose(m);
      const ForwardResult result = forwardKinematics(m, legLengths(m, pose), pose + random.vector(0.003));
      ASSERT_TRUE(result.ok());
      EXPECT_LT((result.pose - pose).norm(), 1e-8);
      EXPECT_LT(result.residual_m, 1e-11);
      EXPECT_LE(result.iterations, 8);
      const double condition = conditionNumber(m, result.pose);
      EXPECT_LE(condition, result.condition_bound * (1 + 1e-9));
      EXPECT_GE(condition, result.condition_bound / 4);
    }
  }
}

TEST(ForwardKinematics, NeverCallsAPoseWithOtherLengthsConverged) {
  RandomPoses random(5, 1e9);
  const Mechanism m = finalMechanism();
  int converged = 0;
  for (int k = 0; k < 5000; ++k) {
    const Pose pose = random.pose(m);
    const Lengths lengths = legLengths(m, pose) + random.vector(0.3);
    const ForwardResult result = forwardKinematics(m, lengths, random.pose(m));
    if (!result.ok()) continue;
    ++converged;
    EXPECT_LT((legLengths(m, result.pose) - lengths).cwiseAbs().maxCoeff(), 2e-11);
  }
  EXPECT_GT(converged, 500);
}

TEST(ForwardKinematics, KeepsTheSignOfTheDeterminantOfItsGuess) {
  RandomPoses random(6, 1e9);
  const Mechanism m = finalMechanism();
  for (int k = 0; k < 5000; ++k) {
    const Pose pose = random.pose(m), guess = random.pose(m);
    const ForwardResult result = forwardKinematics(m, legLengths(m, pose), guess);
    if (!result.ok()) continue;
    EXPECT_GT(lengthJacobian(m, result.pose).determinant() * lengthJacobian(m, guess).determinant(), 0.0);
  }
}

TEST(ForwardKinematics, FollowsItsBranchAlongAPathWithTheLastPoseAsGuess) {
  const Mechanism m = finalMechanism();
  Pose last(0.0, 0.7, 0.0, 0.0);
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.01 * k;
    const Pose pose(0.1 * std::sin(t), 0.7 + 0.08 * std::sin(0.7 * t), 0.12 * std::sin(1.3 * t),
                    0.15 * std::sin(0.9 * t));
    ASSERT_LT(conditionNumber(m, pose), 100.0);
    const ForwardResult result = forwardKinematics(m, legLengths(m, pose), last);
    ASSERT_TRUE(result.ok()) << "at t = " << t;
    ASSERT_LT((result.pose - pose).norm(), 1e-8);
    last = result.pose;
  }
}

TEST(PoseFollower, StaysOnItsBranchAndBeginsAtHomeAgainWhereThereWasNoPose) {
  const Mechanism m = finalMechanism();
  PoseFollower follower;
  EXPECT_EQ(follower.pose(), Pose(Pose::Zero()));
  Pose pose;
  for (int k = 0; k < 500; ++k) {
    const double t = 0.01 * k;
    pose = {0.1 * std::sin(t), 0.7 + 0.08 * std::sin(0.7 * t), 0.12 * std::sin(1.3 * t), 0.15 * std::sin(0.9 * t)};
    ASSERT_TRUE(follower.step(m, legLengths(m, pose))) << "at t = " << t;
    ASSERT_LT((follower.pose() - pose).norm(), 1e-8);
  }
  const Pose last = follower.pose();
  EXPECT_FALSE(follower.step(m, Lengths(0.6, 0.6, 0.6, 3.0)));
  EXPECT_EQ(follower.pose(), last) << "kept";
  ASSERT_TRUE(follower.step(m, legLengths(m, pose)));
  EXPECT_EQ(follower.pose(), forwardKinematicsFromHome(m, legLengths(m, pose)).pose);
  const Pose from_home = follower.pose();
  ASSERT_TRUE(follower.step(m, legLengths(m, pose)));
  EXPECT_EQ(follower.pose(), forwardKinematics(m, legLengths(m, pose), from_home).pose);
  follower.forget();
  ASSERT_TRUE(follower.step(m, legLengths(m, pose)));
  EXPECT_EQ(follower.pose(), from_home);
}

TEST(ForwardKinematics, ReportsLengthsThatNoPoseHas) {
  const Mechanism m = finalMechanism();
  const ForwardResult result = forwardKinematics(m, Lengths(0.6, 0.6, 0.6, 3.0), Pose(0.0, 0.7, 0.0, 0.0));
  EXPECT_EQ(result.status, ForwardStatus::NotConverged);
  EXPECT_GT(result.residual_m, 0.1);
}

TEST(ForwardKinematics, ReportsWhatIsNoLength) {
  const Mechanism m = finalMechanism();
  const Pose guess(0.0, 0.7, 0.0, 0.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(forwardKinematics(m, Lengths(nan, 0.7, 0.7, 0.7), guess).status, ForwardStatus::InvalidInput);
  EXPECT_EQ(forwardKinematics(m, Lengths(0.7, -0.7, 0.7, 0.7), guess).status, ForwardStatus::InvalidInput);
  EXPECT_EQ(forwardKinematics(m, Lengths(0.7, 0.7, 0.7, 0.7), Pose(0, nan, 0, 0)).status, ForwardStatus::InvalidInput);
}

TEST(ForwardKinematics, DoesNotTrustASingularPose) {
  const Mechanism m(geometryOf({0.3, 0.3, 0.3}, 0.0, 60, 60, {0.2, 0.2, 0.2}, 60, 60));
  const Pose pose(0.0, 0.7, 0.0, 0.0);
  EXPECT_EQ(forwardKinematics(m, legLengths(m, pose), pose).status, ForwardStatus::NearSingular);
}

TEST(ForwardKinematicsFromHome, FindsTheBuiltBranchWithoutAGuess) {
  RandomPoses random(7, 40.0);
  for (const Mechanism& m : {finalMechanism(), mechanismB()}) {
    const bool positive = lengthJacobian(m, Pose(0.0, 0.7, 0.0, 0.0)).determinant() > 0.0;
    int asked = 0, found = 0;
    for (int k = 0; k < 2000; ++k) {
      const Pose pose = random.pose(m);
      if ((lengthJacobian(m, pose).determinant() > 0.0) != positive) continue;
      ++asked;
      const ForwardResult result = forwardKinematicsFromHome(m, legLengths(m, pose));
      if (result.ok()) {
        EXPECT_LT((legLengths(m, result.pose) - legLengths(m, pose)).norm(), 1e-10);
      }
      found += result.ok() && (result.pose - pose).norm() < 1e-7;
    }
    EXPECT_GT(asked, 500);
    EXPECT_GT(found, 0.95 * asked);
  }
}

TEST(ForwardKinematicsFromHome, FindsAPoseThatTheStraightPathInTheLengthsMisses) {
  // All lengths 0.6 m: in the final geometry that is far from level, psi = 69 deg.
  const Lengths equal = Lengths::Constant(0.6);
  const ForwardResult result = forwardKinematicsFromHome(finalMechanism(), equal);
  ASSERT_TRUE(result.ok());
  EXPECT_LT((legLengths(finalMechanism(), result.pose) - equal).norm(), 1e-10);
  EXPECT_NEAR(result.pose[3], 1.2115, 1e-3);
}

TEST(ForwardKinematicsFromHome, ReportsLengthsThatNoPoseHas) {
  EXPECT_EQ(forwardKinematicsFromHome(finalMechanism(), Lengths(0.6, 0.6, 0.6, 3.0)).status,
            ForwardStatus::NotConverged);
}

}  // namespace
}  // namespace knee_robot::mechanism
