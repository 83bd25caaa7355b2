#include <gtest/gtest.h>

#include <Eigen/LU>

#include "knee_robot/dynamics/forward_dynamics.h"
#include "knee_robot/dynamics/inverse_dynamics.h"
#include "knee_robot/dynamics/regressor.h"
#include "test/dynamics/random_robots.h"

namespace knee_robot::dynamics {
namespace {

const mechanism::Vector3 kTiltedGravity(0.6, -0.8, -9.7);  // all three components matter

class Dynamics : public testing::Test {
 protected:
  mechanism::RandomPoses random_{11};
  std::vector<mechanism::Mechanism> mechanisms_{mechanism::finalMechanism(), mechanism::startingMechanism(),
                                                mechanism::mechanismB()};
};

TEST_F(Dynamics, OfTheRegressorTimesParametersIsTheInverseDynamics) {
  for (const mechanism::Mechanism& m : mechanisms_) {
    for (int k = 0; k < 300; ++k) {
      const RobotInertia inertia = randomInertia(random_);
      const RigidModel model(m, kTiltedGravity, inertia);
      const mechanism::Motion motion = randomMotion(random_, m);
      RegressorData data;
      ExtendedRegressor extended;
      ASSERT_TRUE(extendedRegressor(m, kTiltedGravity, motion, data, extended));
      ExtendedParameters parameters = ExtendedParameters::Zero();
      parameters.head<kInertialParameters>() = toParameters(inertia);
      parameters.segment<mechanism::kLegs>(extended::kRotor) = inertia.rotor_mass;
      mechanism::Vector4 forces;
      ASSERT_TRUE(inverseDynamics(model, motion, forces));
      EXPECT_LT(relativeError(extended * parameters, forces), 1e-10);
    }
  }
}

TEST_F(Dynamics, ForwardUndoesInverse) {
  for (const mechanism::Mechanism& m : mechanisms_) {
    for (int k = 0; k < 300; ++k) {
      const RigidModel model(m, kTiltedGravity, randomInertia(random_));
      const mechanism::Motion motion = randomMotion(random_, m);
      mechanism::Vector4 forces;
      ASSERT_TRUE(inverseDynamics(model, motion, forces));
      ForwardDynamicsData data;
      ASSERT_TRUE(forwardDynamics(model, motion.pose, motion.pose_velocity, forces, data));
      EXPECT_LT(relativeError(data.acceleration, motion.pose_acceleration), 1e-9);
    }
  }
}

TEST_F(Dynamics, FollowsLagrangesEquationsOfItsOwnEnergies) {
  // d/dt (dT/dxd) - dT/dx + dU/dx = J^T tau, every derivative by central differences of the energies alone.
  const mechanism::Mechanism m = mechanism::finalMechanism();
  for (int k = 0; k < 100; ++k) {
    const RigidModel model(m, kTiltedGravity, randomInertia(random_));
    const mechanism::Motion s = randomMotion(random_, m);
    constexpr double h = 1e-4;
    const auto momentum = [&](const mechanism::Pose& x, const mechanism::Vector4& v, int j) {
      const mechanism::Vector4 e = 0.5 * mechanism::Vector4::Unit(j);  // T is quadratic in v: the difference is exact
      return kineticEnergy(model, x, v + e) - kineticEnergy(model, x, v - e);
    };
    mechanism::Vector4 expected;
    for (int j = 0; j < 4; ++j) {
      const mechanism::Vector4 e = h * mechanism::Vector4::Unit(j);
      const auto momentumAt = [&](double t) {
        return momentum(s.pose + t * s.pose_velocity + 0.5 * t * t * s.pose_acceleration,
                        s.pose_velocity + t * s.pose_acceleration, j);
      };
      expected[j] =
          (momentumAt(h) - momentumAt(-h)) / (2 * h) -
          (kineticEnergy(model, s.pose + e, s.pose_velocity) - kineticEnergy(model, s.pose - e, s.pose_velocity)) /
              (2 * h) +
          (potentialEnergy(model, s.pose + e) - potentialEnergy(model, s.pose - e)) / (2 * h);
    }
    mechanism::Vector4 forces;
    ASSERT_TRUE(inverseDynamics(model, s, forces));
    EXPECT_LT(relativeError(mechanism::lengthJacobian(m, s.pose).transpose() * forces, expected), 1e-6);
  }
}

TEST_F(Dynamics, HoldsStillAgainstTheGradientOfThePotentialEnergy) {
  for (const mechanism::Mechanism& m : mechanisms_) {
    for (int k = 0; k < 100; ++k) {
      const RigidModel model(m, kTiltedGravity, randomInertia(random_));
      const mechanism::Motion still{random_.pose(m), mechanism::Vector4::Zero(), mechanism::Vector4::Zero()};
      mechanism::Vector4 forces, gradient;
      ASSERT_TRUE(inverseDynamics(model, still, forces));
      for (int j = 0; j < 4; ++j) {
        const mechanism::Vector4 e = 1e-5 * mechanism::Vector4::Unit(j);
        gradient[j] = (potentialEnergy(model, still.pose + e) - potentialEnergy(model, still.pose - e)) / 2e-5;
      }
      EXPECT_LT(relativeError(mechanism::lengthJacobian(m, still.pose).transpose() * forces, gradient), 1e-8);
    }
  }
}

TEST_F(Dynamics, TurnsActuatorPowerIntoEnergy) {
  const mechanism::Mechanism m = mechanism::finalMechanism();
  for (int k = 0; k < 200; ++k) {
    const RigidModel model(m, kTiltedGravity, randomInertia(random_));
    const mechanism::Motion s = randomMotion(random_, m);
    mechanism::Vector4 forces;
    ASSERT_TRUE(inverseDynamics(model, s, forces));
    const auto energyAt = [&](double t) {
      const mechanism::Pose x = s.pose + t * s.pose_velocity + 0.5 * t * t * s.pose_acceleration;
      return kineticEnergy(model, x, s.pose_velocity + t * s.pose_acceleration) + potentialEnergy(model, x);
    };
    const double power = forces.dot(mechanism::lengthJacobian(m, s.pose) * s.pose_velocity);
    constexpr double h = 1e-4;
    EXPECT_NEAR(power, (energyAt(h) - energyAt(-h)) / (2 * h), 1e-5 * std::max(1.0, std::abs(power)));
  }
}

TEST_F(Dynamics, CarriesAPlatformOfKnownMassWithItsWeight) {
  // Only the platform has mass, centred over leg 4: the vertical sum of the leg forces is its weight.
  RobotInertia inertia;
  inertia.links[kPlatformLink] = {10.0, mechanism::Vector3(0.05, 0.02, 0.0), 0.1 * mechanism::Matrix3::Identity()};
  const mechanism::Mechanism m = mechanism::finalMechanism();
  const RigidModel model(m, mechanism::Vector3(0, 0, -9.81), inertia);
  const mechanism::Motion still{mechanism::Pose(0.05, 0.7, 0.1, 0.1), mechanism::Vector4::Zero(),
                                mechanism::Vector4::Zero()};
  mechanism::Vector4 forces;
  ASSERT_TRUE(inverseDynamics(model, still, forces));
  mechanism::RobotMotion motion;
  mechanism::robotMotion(m, still, motion);
  double lift = 0.0, push = 0.0;
  for (int i = 0; i < mechanism::kLegs; ++i) {
    lift += forces[i] * motion.legs[i].u.z();
    push += forces[i] * motion.legs[i].u.x();
  }
  EXPECT_NEAR(lift, 98.1, 1e-9);
  EXPECT_NEAR(push, 0.0, 1e-9);
}

TEST_F(Dynamics, PassesFrictionThroughTheVelocitiesOfThePassiveJoints) {
  // Virtual power: actuator friction forces times actuator velocities equal the power lost in all joints.
  const mechanism::Mechanism m = mechanism::finalMechanism();
  for (int k = 0; k < 100; ++k) {
    const mechanism::Motion s = randomMotion(random_, m);
    RegressorData data;
    ASSERT_TRUE(projectedRegressor(m, kTiltedGravity, s, data));
    FrictionParameters friction;
    for (int j = 0; j < kFrictionParameters; ++j)
      friction[j] = random_.uniform(0.0, 2.0);
    double lost = 0.0;
    int column = 0;
    for (int leg = 0; leg < mechanism::kLegs; ++leg) {
      for (int joint = 2; joint >= (leg == 3 ? 1 : 0); --joint, column += 2) {
        const double rate = data.motion.legs[leg].rate[joint];
        lost += friction[column] * rate * rate + friction[column + 1] * std::abs(rate);
      }
    }
    const mechanism::Vector4 forces = data.k.rightCols<kFrictionParameters>() * friction;
    EXPECT_NEAR(forces.dot(data.motion.lengthVelocity()), lost, 1e-9 * (1 + lost));
  }
}

TEST_F(Dynamics, RefusesToProjectAtASingularPose) {
  const mechanism::Mechanism m(mechanism::geometryOf({0.3, 0.3, 0.3}, 0.0, 60, 60, {0.2, 0.2, 0.2}, 60, 60));
  const mechanism::Motion still{mechanism::Pose(0.0, 0.7, 0.0, 0.0), mechanism::Vector4::Zero(),
                                mechanism::Vector4::Zero()};
  RegressorData data;
  EXPECT_FALSE(projectedRegressor(m, kTiltedGravity, still, data));
  mechanism::Vector4 forces;
  EXPECT_FALSE(inverseDynamics(RigidModel(m, kTiltedGravity, randomInertia(random_)), still, forces));
}

}  // namespace
}  // namespace knee_robot::dynamics
