// Inverse dynamics with an auxiliary velocity: Christoffel's factorisation without writing it down, against Simbody and
// by itself.
#include "knee_robot/dynamics/auxiliary_dynamics.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "knee_robot/dynamics/inverse_dynamics.h"
#include "knee_robot/simulation/simbody_robot.h"
#include "test/dynamics/random_robots.h"

namespace knee_robot::dynamics {
namespace {

using mechanism::Matrix4;
using mechanism::Vector4;

class AuxiliaryDynamics : public testing::TestWithParam<const char*> {
 protected:
  AuxiliaryDynamics()
      : robot_(mechanism::loadRobot(std::string(KNEE_SOURCE_DIR) + "/config/robots/" + GetParam() + ".yaml")),
        inertia_(loadRobotInertia(robot_)),
        model_(robot_, inertia_) {}
  const mechanism::Mechanism& mechanism() const { return *robot_.mechanism; }
  Vector4 forces(const mechanism::Pose& pose, const Vector4& velocity, const Vector4& reference,
                 const Vector4& acceleration) {
    Vector4 found = Vector4::Constant(NAN);
    EXPECT_TRUE(auxiliaryForces(model_, pose, {velocity, reference, acceleration}, data_, found));
    return found;
  }
  Matrix4 mass(const mechanism::Pose& pose) {
    Matrix4 all;
    for (int i = 0; i < 4; ++i)
      all.col(i) = forces(pose, Vector4::Zero(), Vector4::Zero(), Vector4::Unit(i));
    return all;
  }
  Matrix4 coriolis(const mechanism::Pose& pose, const Vector4& velocity) {
    Matrix4 all;
    for (int i = 0; i < 4; ++i)
      all.col(i) = forces(pose, velocity, Vector4::Unit(i), Vector4::Zero());
    return all;
  }
  /// The largest element of the symmetric part of dM/dt - 2C, and of the whole, along random motions.
  std::pair<double, double> skewness() {
    double symmetric = 0.0, whole = 0.0;
    for (int k = 0; k < 50; ++k) {
      const mechanism::Pose pose = random_.pose(mechanism());
      const Vector4 pose_velocity = random_.vector(0.5);
      const Vector4 velocity = mechanism::lengthJacobian(mechanism(), pose) * pose_velocity;
      const auto change_over = [&](double t) -> Matrix4 {
        return mass(pose + t * pose_velocity) - mass(pose - t * pose_velocity);
      };
      const double h = 1e-4;
      const Matrix4 change = (8.0 * change_over(h) - change_over(2.0 * h)) / (12.0 * h);
      const Matrix4 rest = change - 2.0 * coriolis(pose, velocity);
      symmetric = std::max(symmetric, (rest + rest.transpose()).cwiseAbs().maxCoeff());
      whole = std::max(whole, rest.cwiseAbs().maxCoeff());
    }
    return {symmetric, whole};
  }

  mechanism::Robot robot_;
  RobotInertia inertia_;
  PartedModel model_;
  AuxiliaryData data_;
  mechanism::RandomPoses random_{17, kConditionMaximum};
};

TEST_P(AuxiliaryDynamics, IsTheOrdinaryInverseDynamicsLessTheWeightWhereBothVelocitiesAreOne) {
  const RigidModel rigid(mechanism(), robot_.gravity, inertia_);
  for (int k = 0; k < 200; ++k) {
    const mechanism::Motion motion = randomMotion(random_, mechanism());
    const mechanism::Motion still{motion.pose, Vector4::Zero(), Vector4::Zero()};
    Vector4 moving, weight;
    ASSERT_TRUE(inverseDynamics(rigid, motion, moving));
    ASSERT_TRUE(inverseDynamics(rigid, still, weight));
    mechanism::RobotMotion all;
    mechanism::robotMotion(mechanism(), motion, all);
    const Vector4 velocity = all.lengthVelocity();
    const Vector4 ours = forces(motion.pose, velocity, velocity, all.lengthAcceleration());
    EXPECT_LT((ours - (moving - weight)).norm(), 1e-7 * std::max(1.0, moving.norm()));
  }
}

TEST_P(AuxiliaryDynamics, LeavesTheRateOfTheMassLessTwiceCoriolisSkewSymmetric) {
  const auto [symmetric, whole] = skewness();
  std::printf("dM/dt - 2C: symmetric part %.2e, the whole %.2e kg/s\n", symmetric, whole);
  EXPECT_GT(whole, 0.1) << "nothing would be checked";
  EXPECT_LT(symmetric, 1e-6 * whole);
}

TEST_P(AuxiliaryDynamics, DoesSoForParametersThatNoBodyHas) {
  for (int k = 0; k < kInertialParameters; ++k)
    model_.parameters[k] = random_.vector(2.0)[k % 4];
  const auto [symmetric, whole] = skewness();
  EXPECT_GT(whole, 0.1);
  EXPECT_LT(symmetric, 1e-6 * whole);
}

TEST_P(AuxiliaryDynamics, AgreesWithSimbodysMassAndVelocityForces) {
  simulation::SimbodyRobot peer(mechanism(), robot_.gravity, inertia_);
  const auto theirs = [&](const mechanism::Pose& pose, const Vector4& velocity, const Vector4& acceleration) {
    mechanism::Motion motion;
    motion.pose = pose;
    EXPECT_TRUE(mechanism::poseRates(mechanism(), pose, velocity, acceleration, motion.pose_velocity,
                                     motion.pose_acceleration));
    const mechanism::CoordinateMotion all = mechanism::coordinateMotion(mechanism(), motion);
    peer.set(all);
    return peer.actuatorForces(all);
  };
  double worst = 0.0;
  for (int k = 0; k < 200; ++k) {
    const mechanism::Pose pose = random_.pose(mechanism());
    const Vector4 v = random_.vector(0.3), w = random_.vector(0.3), a = random_.vector(2.0);
    const Vector4 none = Vector4::Zero();
    // The symmetric bilinear form of their velocity forces, by their own numbers.
    const Vector4 peers = theirs(pose, none, a) - theirs(pose, none, none) +
                          0.25 * (theirs(pose, v + w, none) - theirs(pose, v - w, none));
    worst = std::max(worst, (forces(pose, v, w, a) - peers).norm() / std::max(1.0, peers.norm()));
    mechanism::Motion moving;
    moving.pose = pose;
    ASSERT_TRUE(mechanism::poseRates(mechanism(), pose, v, none, moving.pose_velocity, moving.pose_acceleration));
    peer.set(mechanism::coordinateMotion(mechanism(), moving));
    EXPECT_NEAR(0.5 * v.dot(mass(pose) * v), peer.kineticEnergy(), 1e-8 * (1.0 + peer.kineticEnergy()));
  }
  std::printf("largest relative difference: %.2e\n", worst);
  EXPECT_LT(worst, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Robots, AuxiliaryDynamics, testing::Values("final", "starting"));

}  // namespace
}  // namespace knee_robot::dynamics
