// Independent verification: Simbody builds the closed mechanism from the same URDF inertias and must agree.
#include <gtest/gtest.h>

#include <cstdio>

#include "knee_robot/dynamics/forward_dynamics.h"
#include "knee_robot/dynamics/inverse_dynamics.h"
#include "knee_robot/simulation/simbody_robot.h"
#include "test/dynamics/random_robots.h"

namespace knee_robot::dynamics {
namespace {

constexpr int kStates = 1000;

class Simbody : public testing::TestWithParam<const char*> {
 protected:
  Simbody()
      : robot_(mechanism::loadRobot(std::string(KNEE_SOURCE_DIR) + "/config/robots/" + GetParam() + ".yaml")),
        inertia_(loadRobotInertia(robot_)),
        model_(*robot_.mechanism, robot_.gravity, inertia_),
        peer_(*robot_.mechanism, robot_.gravity, inertia_) {}
  const mechanism::Mechanism& mechanism() const { return *robot_.mechanism; }

  mechanism::Robot robot_;
  RobotInertia inertia_;
  RigidModel model_;
  simulation::SimbodyRobot peer_;
  mechanism::RandomPoses random_{41, kConditionMaximum};
};

TEST_P(Simbody, AgreesWithTheForwardAccelerations) {
  double worst = 0.0;
  for (int k = 0; k < kStates; ++k) {
    const mechanism::Motion motion{random_.pose(mechanism()), random_.vector(0.5), mechanism::Vector4::Zero()};
    const mechanism::Vector4 forces = random_.vector(200.0);
    ForwardDynamicsData data;
    ASSERT_TRUE(forwardDynamics(model_, motion.pose, motion.pose_velocity, forces, data));
    const mechanism::Vector4 ours = mechanism::lengthJacobian(mechanism(), motion.pose) * data.acceleration +
                                    mechanism::lengthBias(mechanism(), motion.pose, motion.pose_velocity);
    peer_.set(mechanism::coordinateMotion(mechanism(), motion));
    worst = std::max(worst, relativeError(ours, peer_.actuatorAccelerations(forces)));
  }
  std::printf("largest relative difference over %d states: %.2e\n", kStates, worst);
  EXPECT_LT(worst, 1e-6);
}

TEST_P(Simbody, AgreesWithTheInverseForces) {
  double worst = 0.0;
  for (int k = 0; k < kStates; ++k) {
    const mechanism::Motion motion = randomMotion(random_, mechanism());
    mechanism::Vector4 ours;
    ASSERT_TRUE(inverseDynamics(model_, motion, ours));
    const mechanism::CoordinateMotion all = mechanism::coordinateMotion(mechanism(), motion);
    peer_.set(all);
    worst = std::max(worst, relativeError(ours, peer_.actuatorForces(all)));
  }
  std::printf("largest relative difference over %d states: %.2e\n", kStates, worst);
  EXPECT_LT(worst, 1e-6);
}

TEST_P(Simbody, AgreesWithTheForcesInTheCutJoints) {
  for (int k = 0; k < 200; ++k) {
    mechanism::Motion motion{random_.pose(mechanism()), random_.vector(0.5), mechanism::Vector4::Zero()};
    const mechanism::Vector4 forces = random_.vector(200.0);
    ForwardDynamicsData data;
    ASSERT_TRUE(forwardDynamics(model_, motion.pose, motion.pose_velocity, forces, data));
    motion.pose_acceleration = data.acceleration;
    mechanism::RobotMotion all;
    mechanism::robotMotion(mechanism(), motion, all);
    const std::array<mechanism::Vector3, 3> ours = sphericalJointForces(model_, all, forces);
    peer_.set(mechanism::coordinateMotion(mechanism(), motion));
    peer_.actuatorAccelerations(forces);
    const std::array<mechanism::Vector3, 3> theirs = peer_.ballForces(forces);
    for (int i = 0; i < 3; ++i)
      EXPECT_LT((ours[i] - theirs[i]).norm(), 1e-6 * std::max(1.0, theirs[i].norm()));
  }
}

TEST_P(Simbody, AgreesWithTheEnergies) {
  for (int k = 0; k < 100; ++k) {
    const mechanism::Motion motion = randomMotion(random_, mechanism());
    peer_.set(mechanism::coordinateMotion(mechanism(), motion));
    const double kinetic = kineticEnergy(model_, motion.pose, motion.pose_velocity);
    EXPECT_NEAR(kinetic, peer_.kineticEnergy(), 1e-10 * (1.0 + kinetic));
    // Simbody's zero of the potential is where the body origins are at height zero, as here.
    EXPECT_NEAR(kinetic + potentialEnergy(model_, motion.pose), peer_.energy(), 1e-9 * 100.0);
  }
}

TEST_P(Simbody, AgreesForLinksWithoutAnySymmetry) {
  for (int robot = 0; robot < 10; ++robot) {
    RobotInertia inertia = randomInertia(random_);
    inertia.rotor_mass.setZero();  // Simbody has no reflected rotors
    const mechanism::Vector3 gravity(1.0, -2.0, -9.0);
    const RigidModel model(mechanism(), gravity, inertia);
    simulation::SimbodyRobot peer(mechanism(), gravity, inertia);
    for (int k = 0; k < 20; ++k) {
      const mechanism::Motion motion = randomMotion(random_, mechanism());
      const mechanism::CoordinateMotion all = mechanism::coordinateMotion(mechanism(), motion);
      mechanism::Vector4 forces;
      ASSERT_TRUE(inverseDynamics(model, motion, forces));
      peer.set(all);
      EXPECT_LT(relativeError(forces, peer.actuatorForces(all)), 1e-6);
      EXPECT_LT(relativeError(mechanism::lengthsOf(all.acceleration), peer.actuatorAccelerations(forces)), 1e-6);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BothGeometries, Simbody, testing::Values("final", "starting"));

}  // namespace
}  // namespace knee_robot::dynamics
