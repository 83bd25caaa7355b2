#include <gtest/gtest.h>

#include <cmath>

#include "test/mechanism/random_poses.h"

namespace knee_robot::mechanism {
namespace {

TEST(Mechanism, PlacesTheJointsWhereTableOneSays) {
  const Mechanism m = finalMechanism();
  EXPECT_TRUE(m.base_points[0].isApprox(Vector3(-0.4, 0, 0), 1e-12));
  EXPECT_LT((m.base_points[1] - Vector3(0, 0.4, 0)).norm(), 1e-12);
  EXPECT_LT((m.base_points[2] - Vector3(0.4 * std::sqrt(0.5), -0.4 * std::sqrt(0.5), 0)).norm(), 1e-12);
  EXPECT_LT((m.base_points[3] - Vector3(0.15, 0, 0)).norm(), 1e-12);
  EXPECT_LT((m.platform_points[2] - Vector3(0, -0.3, 0)).norm(), 1e-12);
}

TEST(InverseKinematics, MatchesLengthsWorkedByHandAtALevelPose) {
  // X = 0, level: leg 1 spans 0.1 sideways, leg 4 spans 0.15; leg 2 from (0, 0.4) to 0.3 (cos 50, sin 50).
  const Pose pose(0.0, 0.7, 0.0, 0.0);
  const Lengths lengths = legLengths(finalMechanism(), pose);
  EXPECT_NEAR(lengths[0], std::sqrt(0.01 + 0.49), 1e-15);
  EXPECT_NEAR(lengths[3], std::sqrt(0.0225 + 0.49), 1e-15);
  const double dx = 0.3 * 0.6427876096865394, dy = 0.3 * 0.766044443118978 - 0.4;
  EXPECT_NEAR(lengths[1], std::sqrt(dx * dx + dy * dy + 0.49), 1e-15);
}

TEST(InverseKinematics, ReproducesThePapersPrintedSingularPoint) {
  // Section 2.2: q13 = 0.2236, q23 = q33 = 0.2276, q44 = 0.2. Neither column of Table 1: R = 0.3 with the starting
  // angles.
  const Mechanism m(geometryOf({0.3, 0.3, 0.3}, 0.0, 50, 40, {0.2, 0.2, 0.2}, 40, 30));
  const Pose pose(0.0, 0.2, 0.0, 0.0);
  const Lengths lengths = legLengths(m, pose);
  EXPECT_NEAR(lengths[0], 0.2236067977, 1e-10);
  EXPECT_NEAR(lengths[1], 0.2276468090, 1e-10);
  EXPECT_NEAR(lengths[2], 0.2276468089, 1.1e-10);
  EXPECT_NEAR(lengths[3], 0.2, 1e-10);
}

TEST(InverseKinematics, PutsTheTipsOfEquations7To10OntoThePlatform) {
  RandomPoses random(1);
  for (const Mechanism& m : {finalMechanism(), startingMechanism(), mechanismB()}) {
    for (int k = 0; k < 1000; ++k) {
      const Pose pose = random.pose(m);
      const JointCoordinates q = inverseKinematics(m, pose);
      const Vector3 origin(pose[0], 0.0, pose[1]);
      for (int i = 0; i < 3; ++i) {
        const Vector3 direction(std::cos(q.q1[i]) * std::cos(q.q2[i]), std::sin(q.q2[i]),
                                std::sin(q.q1[i]) * std::cos(q.q2[i]));
        const Vector3 tip = m.base_points[i] + q.q3[i] * direction;
        EXPECT_LT((tip - origin - platformRotation(pose) * m.platform_points[i]).norm(), 1e-14);
      }
      const Vector3 center = m.base_points[3] + q.q42 * Vector3(std::cos(q.q41), 0.0, std::sin(q.q41));
      EXPECT_LT((center - origin).norm(), 1e-14);
    }
  }
}

TEST(PlatformRotation, IsThetaAboutYThenPsiAboutTheTurnedZ) {
  const Pose pose(0.1, 0.7, 0.3, -0.4);
  const Matrix3 expected =
      (Eigen::AngleAxisd(0.3, Vector3::UnitY()) * Eigen::AngleAxisd(-0.4, Vector3::UnitZ())).matrix();
  EXPECT_LT((platformRotation(pose) - expected).norm(), 1e-15);
}

TEST(LengthJacobian, AgreesWithFiniteDifferencesOverRandomPoses) {
  RandomPoses random(2);
  for (const Mechanism& m : {finalMechanism(), startingMechanism(), mechanismB()}) {
    for (int k = 0; k < 1000; ++k) {
      const Pose pose = random.pose(m);
      const Matrix4 jacobian = lengthJacobian(m, pose);
      constexpr double kStep = 1e-5;
      for (int j = 0; j < 4; ++j) {
        const Vector4 step = kStep * Vector4::Unit(j);
        const Vector4 slope = (legLengths(m, pose + step) - legLengths(m, pose - step)) / (2 * kStep);
        EXPECT_LT((jacobian.col(j) - slope).norm(), 1e-9);
      }
    }
  }
}

TEST(LengthBias, AgreesWithSecondDifferencesAlongACurve) {
  RandomPoses random(3);
  const Mechanism m = finalMechanism();
  for (int k = 0; k < 1000; ++k) {
    const Pose pose = random.pose(m);
    const Vector4 velocity = random.vector(0.5), acceleration = random.vector(1.0);
    constexpr double kStep = 1e-4;
    const auto lengthsAt = [&](double t) { return legLengths(m, pose + t * velocity + 0.5 * t * t * acceleration); };
    const Vector4 second = (lengthsAt(kStep) - 2 * lengthsAt(0) + lengthsAt(-kStep)) / (kStep * kStep);
    const Vector4 expected = lengthJacobian(m, pose) * acceleration + lengthBias(m, pose, velocity);
    EXPECT_LT((second - expected).norm(), 2e-7);
    Vector4 pose_velocity, pose_acceleration;
    ASSERT_TRUE(poseRates(m, pose, lengthJacobian(m, pose) * velocity, expected, pose_velocity, pose_acceleration));
    EXPECT_LT((pose_velocity - velocity).norm(), 1e-11);
    EXPECT_LT((pose_acceleration - acceleration).norm(), 1e-11);
  }
}

TEST(JointAngles, AreZeroForAVerticalLegUnderALevelPlatformAndHalfAFullTurnLess) {
  // Equal base and platform triangles: level legs stand upright.
  const Mechanism m(geometryOf({0.3, 0.3, 0.3}, 0.0, 90, 45, {0.3, 0.3, 0.3}, 90, 45));
  const JointAngles upright = jointAngles(m, Pose(0.0, 0.7, 0.0, 0.0));
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(upright.base[i], 0.0, 1e-12);
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(upright.platform[i], 0.0, 1e-12);
  const JointAngles moved = jointAngles(m, Pose(0.7, 0.7, 0.0, 0.0));
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(moved.base[i], M_PI / 4, 1e-12);
  // Turning the platform about leg 4's joint leaves leg 4 upright.
  const JointAngles tilted = jointAngles(m, Pose(0.0, 0.7, 0.2, 0.0));
  EXPECT_NEAR(tilted.base[3], 0.0, 1e-12);
  EXPECT_GT(tilted.platform[0], 0.15);
}

TEST(ConditionNumber, OfTheFinalGeometryAtTheAnkleExerciseIsPracticallySingular) {
  // theta = -30 deg at Z = 0.7 m: the paper's ankle exercise does not fit into the final geometry.
  EXPECT_NEAR(conditionNumber(finalMechanism(), Pose(0.0, 0.7, -M_PI / 6, 0.0)), 690.0, 5.0);
}

TEST(ConditionNumber, OfTheStartingGeometryIsHighOverAllOfEquation31sRange) {
  for (double z = 0.3758; z <= 0.5753; z += 0.01) {
    const double condition = conditionNumber(startingMechanism(), Pose(0.0, z, 0.0, 0.0));
    EXPECT_GT(condition, 85.0);
    EXPECT_LT(condition, 101.0);
  }
}

TEST(ConditionNumber, OfASymmetricLevelPoseIsInfinite) {
  const Mechanism m(geometryOf({0.3, 0.3, 0.3}, 0.0, 60, 60, {0.2, 0.2, 0.2}, 60, 60));
  EXPECT_TRUE(std::isinf(conditionNumber(m, Pose(0.0, 0.7, 0.0, 0.0))));
}

}  // namespace
}  // namespace knee_robot::mechanism
