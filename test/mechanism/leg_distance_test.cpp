// What lies between two legs: lengths by hand, gradients by finite differences.
#include "knee_robot/mechanism/leg_distance.h"

#include <gtest/gtest.h>

#include "random_poses.h"

namespace knee_robot::mechanism {
namespace {

constexpr BetweenLegs kAll[] = {BetweenLegs::Lengths, BetweenLegs::Cylinders, BetweenLegs::Rods};

TEST(LegDistance, HasTheGradientThatDifferencesGive) {
  for (const Mechanism& mechanism : {finalMechanism(), startingMechanism(), mechanismB()}) {
    RandomPoses poses(7);
    for (int trial = 0; trial < 20; ++trial) {
      const Pose pose = poses.pose(mechanism);
      for (int first = 0; first < kLegs; ++first) {
        for (int second = first + 1; second < kLegs; ++second) {
          for (const BetweenLegs between : kAll) {
            const LegPair pair{first, second, between, 0.25};
            const Vector4 gradient = legDistance(mechanism, pose, pair).by_pose;
            for (int i = 0; i < 4; ++i) {
              const Vector4 step = 1e-6 * Vector4::Unit(i);
              const double slope = (legDistance(mechanism, pose + step, pair).length_m -
                                    legDistance(mechanism, pose - step, pair).length_m) /
                                   2e-6;
              EXPECT_NEAR(gradient[i], slope, 1e-7) << first << second << static_cast<int>(between) << " " << i;
            }
          }
        }
      }
    }
  }
}

TEST(LegDistance, OfTheLengthsIsTheirDifference) {
  const Mechanism mechanism = finalMechanism();
  const Pose pose(0.05, 0.7, 0.1, -0.1);
  const Lengths lengths = legLengths(mechanism, pose);
  const LegDistance between = legDistance(mechanism, pose, {1, 3, BetweenLegs::Lengths});
  EXPECT_NEAR(between.length_m, lengths[1] - lengths[3], 1e-12);
  const Matrix4 jacobian = lengthJacobian(mechanism, pose);
  EXPECT_TRUE(between.by_pose.isApprox((jacobian.row(1) - jacobian.row(3)).transpose(), 1e-9));
}

TEST(LegDistance, OfPointsAtTheJointsIsThatOfTheJoints) {
  const Mechanism mechanism = finalMechanism();
  const Pose pose(0.05, 0.7, 0.1, -0.1);
  const LegDistance below = legDistance(mechanism, pose, {0, 2, BetweenLegs::Cylinders, 0.0});
  EXPECT_NEAR(below.length_m, (mechanism.base_points[0] - mechanism.base_points[2]).norm(), 1e-12);
  EXPECT_TRUE(below.by_pose.isZero(1e-12)) << "the base does not move";
  const LegDistance above = legDistance(mechanism, pose, {0, 2, BetweenLegs::Rods, 0.0});
  EXPECT_NEAR(above.length_m, (mechanism.platform_points[0] - mechanism.platform_points[2]).norm(), 1e-12);
  EXPECT_TRUE(above.by_pose.isZero(1e-12)) << "nor does the platform change its size";
}

}  // namespace
}  // namespace knee_robot::mechanism
