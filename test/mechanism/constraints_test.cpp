#include "knee_robot/mechanism/constraints.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "knee_robot/mechanism/singularity.h"
#include "test/mechanism/random_poses.h"

namespace knee_robot::mechanism {
namespace {

class Constraints : public testing::Test {
 protected:
  Motion motion(const Mechanism& mechanism) {
    return {random_.pose(mechanism), random_.vector(0.5), random_.vector(2.0)};
  }
  RandomPoses random_{31};
  std::vector<Mechanism> mechanisms_{finalMechanism(), startingMechanism(), mechanismB()};
};

TEST_F(Constraints, HoldOnPositionVelocityAndAccelerationLevel) {
  for (const Mechanism& m : mechanisms_) {
    for (int k = 0; k < 1000; ++k) {
      const CoordinateMotion q = coordinateMotion(m, motion(m));
      EXPECT_LT(constraints(m, q.position).norm(), 1e-14);
      const ConstraintJacobian a = constraintJacobian(m, q.position);
      EXPECT_LT((a * q.velocity).norm(), 1e-13);
      EXPECT_LT((a * q.acceleration - constraintBias(m, q.position, q.velocity)).norm(), 1e-12);
    }
  }
}

TEST_F(Constraints, HaveTheJacobianThatFiniteDifferencesGiveAlsoWhereNotAssembled) {
  for (const Mechanism& m : mechanisms_) {
    for (int k = 0; k < 300; ++k) {
      Coordinates q = coordinateMotion(m, motion(m)).position;
      for (int j = 0; j < kCoordinates; ++j)
        q[j] += random_.uniform(-0.1, 0.1);
      const ConstraintJacobian a = constraintJacobian(m, q);
      for (int j = 0; j < kCoordinates; ++j) {
        const Coordinates step = 1e-5 * Coordinates::Unit(j);
        const ConstraintVector slope = (constraints(m, q + step) - constraints(m, q - step)) / 2e-5;
        EXPECT_LT((a.col(j) - slope).norm(), 1e-9) << "coordinate " << j;
      }
    }
  }
}

TEST_F(Constraints, HaveTheBiasThatTheJacobiansDifferenceGives) {
  for (const Mechanism& m : mechanisms_) {
    for (int k = 0; k < 300; ++k) {
      const CoordinateMotion q = coordinateMotion(m, motion(m));
      const double h = 1e-5;
      const ConstraintVector expected =
          -(constraintJacobian(m, q.position + h * q.velocity) - constraintJacobian(m, q.position - h * q.velocity)) *
          q.velocity / (2 * h);
      EXPECT_LT((constraintBias(m, q.position, q.velocity) - expected).norm(), 1e-8);
    }
  }
}

TEST_F(Constraints, GiveThePassiveJointsMotionFromTheActuators) {
  for (const Mechanism& m : mechanisms_) {
    for (int k = 0; k < 500; ++k) {
      const CoordinateMotion q = coordinateMotion(m, motion(m));
      Coordinates velocity, acceleration;
      ASSERT_TRUE(
          coordinateRates(m, q.position, lengthsOf(q.velocity), lengthsOf(q.acceleration), velocity, acceleration));
      EXPECT_LT((velocity - q.velocity).norm(), 1e-10);
      EXPECT_LT((acceleration - q.acceleration).norm(), 1e-9);
      DependentJacobian x;
      ASSERT_TRUE(dependentJacobian(m, q.position, x));
      const ConstraintVector dependent = -x * lengthsOf(q.velocity);
      for (int j = 0; j < kConstraints; ++j)
        EXPECT_NEAR(dependent[j], q.velocity[kDependent[j]], 1e-10);
    }
  }
}

TEST_F(Constraints, DoNotDetermineTheMotionAtATypeTwoSingularity) {
  const Mechanism m(geometryOf({0.3, 0.3, 0.3}, 0.0, 60, 60, {0.2, 0.2, 0.2}, 60, 60));
  Motion still;
  still.pose = Pose(0.0, 0.7, 0.0, 0.0);
  DependentJacobian x;
  EXPECT_FALSE(dependentJacobian(m, coordinateMotion(m, still).position, x));
  const Singularity s = singularityAt(m, still.pose);
  EXPECT_TRUE(std::isinf(s.condition));
  EXPECT_TRUE(std::isinf(s.dependent_condition));
  EXPECT_NEAR(s.determinant, 0.0, 1e-15);
  EXPECT_GT(s.type_one, 0.5);
}

TEST_F(Constraints, MakeTheDependentDeterminantTheProductOfTypeOneAndTypeTwo) {
  // det A_d = +- det(J) * prod(q_i3^2 cos q_i2) * q42: both kinds of singularity and nothing else make it zero.
  for (const Mechanism& m : mechanisms_) {
    for (int k = 0; k < 100; ++k) {
      const CoordinateMotion q = coordinateMotion(m, motion(m));
      const ConstraintJacobian a = constraintJacobian(m, q.position);
      Eigen::Matrix<double, kConstraints, kConstraints> dependent;
      for (int j = 0; j < kConstraints; ++j)
        dependent.col(j) = a.col(kDependent[j]);
      const Singularity s = singularityAt(m, poseOf(q.position));
      const Vector4 l = lengthsOf(q.position);
      const double product = s.determinant * s.type_one * std::pow(l[0] * l[1] * l[2], 2) * l[3];
      EXPECT_NEAR(std::abs(dependent.determinant()), std::abs(product), 1e-10);
    }
  }
}

TEST_F(Constraints, KeepTheScaledMeasuresWhenTheUnitOfLengthChanges) {
  const Mechanism m = finalMechanism();
  Geometry g = m.geometry;
  for (int i = 0; i < 3; ++i) {
    g.R[i] *= 10;
    g.Rm[i] *= 10;
  }
  g.ds *= 10;
  const Mechanism large(g);
  for (int k = 0; k < 100; ++k) {
    const Pose pose = random_.pose(m);
    const Singularity a = singularityAt(m, pose);
    const Singularity b = singularityAt(large, Pose(10 * pose[0], 10 * pose[1], pose[2], pose[3]));
    EXPECT_NEAR(a.scaled_condition, b.scaled_condition, 1e-8 * a.scaled_condition);
    EXPECT_NEAR(a.force_amplification, b.force_amplification, 1e-8 * a.force_amplification);
    EXPECT_GT(std::abs(a.condition - b.condition), 1e-3);
  }
}

TEST(FoldDistance, IsTheLengthChangeThatSeparatesTheRobotFromTheMeetingOfTwoAssemblyModes) {
  Geometry g;  // the printed singular point
  g.R = {0.3, 0.3, 0.3};
  g.beta_FD = g.beta_FI = 50.0 * M_PI / 180.0;
  g.Rm = {0.2, 0.2, 0.2};
  g.beta_MD = g.beta_MI = 40.0 * M_PI / 180.0;
  const Mechanism m(g);
  // From a regular pose, not a symmetric one, along one coordinate until det J changes sign: a fold.
  Pose from(0.05, 0.5, 0.05, 0.15), to = from;
  for (double theta = 0.05; theta < 1.4; theta += 0.01) {
    to[2] = theta;
    if (lengthJacobian(m, to).determinant() * lengthJacobian(m, from).determinant() < 0.0) break;
  }
  ASSERT_LT(lengthJacobian(m, to).determinant() * lengthJacobian(m, from).determinant(), 0.0);
  for (int k = 0; k < 60; ++k) {
    const Pose middle = (from + to) / 2;
    const bool same = lengthJacobian(m, middle).determinant() * lengthJacobian(m, from).determinant() > 0.0;
    (same ? from : to) = middle;
  }
  EXPECT_LT(foldDistance(m, from), 1e-12);
  const Eigen::JacobiSVD<Matrix4> svd(lengthJacobian(m, from), Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector4 free = svd.matrixV().col(3);   // moves without the lengths, to first order
  const Vector4 bound = svd.matrixU().col(3);  // lengths that no motion reaches, to first order
  for (const double step : {0.0025, 0.005, 0.01}) {
    const Pose pose = from + step * free, mirrored = from - step * free;
    const double needed = std::abs(bound.dot(legLengths(m, pose) - legLengths(m, from)));
    EXPECT_NEAR(foldDistance(m, pose) / needed, 1.0, 0.2) << step;
    EXPECT_LT((legLengths(m, pose) - legLengths(m, mirrored)).norm(), 0.2 * needed)
        << "two poses, nearly the same lengths";
  }
}

}  // namespace
}  // namespace knee_robot::mechanism
