// Free motion keeps its energy, and no real-time function allocates.
#include <gtest/gtest.h>

#include <cstdio>

#include "knee_robot/dynamics/forward_dynamics.h"
#include "knee_robot/dynamics/inverse_dynamics.h"
#include "knee_robot/dynamics/regressor.h"
#include "knee_robot/mechanism/constraints.h"
#include "knee_robot/mechanism/singularity.h"
#include "test/allocation_guard.h"
#include "test/dynamics/random_robots.h"

namespace knee_robot::dynamics {
namespace {

struct State {
  mechanism::Pose pose;
  mechanism::Vector4 velocity;
};

State derivative(const RigidModel& model, const State& s, ForwardDynamicsData& data) {
  forwardDynamics(model, s.pose, s.velocity, mechanism::Vector4::Zero(), data);
  return {s.velocity, data.acceleration};
}

/// One classical Runge-Kutta step of fourth order.
State step(const RigidModel& model, const State& s, double h, ForwardDynamicsData& data) {
  const auto moved = [&s](const State& d, double t) { return State{s.pose + t * d.pose, s.velocity + t * d.velocity}; };
  const State a = derivative(model, s, data), b = derivative(model, moved(a, h / 2), data);
  const State c = derivative(model, moved(b, h / 2), data), d = derivative(model, moved(c, h), data);
  return {s.pose + h / 6 * (a.pose + 2 * b.pose + 2 * c.pose + d.pose),
          s.velocity + h / 6 * (a.velocity + 2 * b.velocity + 2 * c.velocity + d.velocity)};
}

double drift(double h) {
  mechanism::RandomPoses random(61);
  const RobotInertia inertia = randomInertia(random);
  const RigidModel model(mechanism::finalMechanism(), mechanism::Vector3::Zero(),
                         inertia);  // weightless: 2 s of fall would leave the workspace
  State s{mechanism::Pose(0.0, 0.7, 0.1, 0.1), mechanism::Vector4(0.6, 0.8, 1.5, -1.5)};
  s.velocity *= std::sqrt(45.0 / kineticEnergy(model, s.pose, s.velocity));
  const double start = kineticEnergy(model, s.pose, s.velocity);
  ForwardDynamicsData data;
  double worst = 0.0;
  for (int k = 0; k < static_cast<int>(2.0 / h + 0.5); ++k) {
    s = step(model, s, h, data);
    worst = std::max(worst, std::abs(kineticEnergy(model, s.pose, s.velocity) - start));
  }
  return worst;
}

TEST(FreeMotion, KeepsItsEnergyWithTheIntegratorsOrder) {
  const double fine = drift(1e-3), coarse = drift(4e-3);
  std::printf("energy drift from 45 J over 2 s: %.2e J at 1 ms, %.2e J at 4 ms\n", fine, coarse);
  EXPECT_LT(fine, 1e-6);
  // Fourth order or better: a wrong force would leave a drift that no step size removes.
  EXPECT_GT(coarse / fine, 100.0);
}

TEST(RealTimeFunctions, DoNotAllocate) {
  mechanism::RandomPoses random(62);
  const mechanism::Mechanism m = mechanism::finalMechanism();
  const RigidModel model(m, mechanism::Vector3(0, 0, -9.81), randomInertia(random));
  const mechanism::Motion motion = randomMotion(random, m);
  RegressorData regressor;
  ExtendedRegressor extended;
  ForwardDynamicsData data;
  mechanism::Vector4 forces = mechanism::Vector4::Zero();
  mechanism::Motion found;
  mechanism::Coordinates velocity, acceleration;
  mechanism::DependentJacobian x;
  mechanism::RobotMotion all;
  const mechanism::Lengths lengths = mechanism::legLengths(m, motion.pose);
  const mechanism::Pose guess = motion.pose + mechanism::Vector4::Constant(0.001);

  allocations = 0;
  armed = true;
  bool done = extendedRegressor(m, model.gravity, motion, regressor, extended);
  done = inverseDynamics(model, motion, forces) && done;
  done = forwardDynamics(model, motion.pose, motion.pose_velocity, forces, data) && done;
  done = mechanism::motionFromLengths(m, lengths, forces * 1e-3, forces * 1e-3, guess, found) ==
             mechanism::ForwardStatus::Converged &&
         done;
  const mechanism::CoordinateMotion q = mechanism::coordinateMotion(m, motion);
  done = mechanism::coordinateRates(m, q.position, forces * 1e-3, forces * 1e-3, velocity, acceleration) && done;
  done = mechanism::dependentJacobian(m, q.position, x) && done;
  mechanism::robotMotion(m, motion, all);
  forces += sphericalJointForces(model, all, forces)[0].homogeneous();
  done = mechanism::singularityAt(m, motion.pose).condition > 1.0 &&
         mechanism::jointAngles(m, motion.pose).base[0] > -1.0 && done;
  done = mechanism::forwardKinematicsFromHome(m, lengths).iterations > 0 && done;
  const double energy = kineticEnergy(model, motion.pose, motion.pose_velocity) + potentialEnergy(model, motion.pose);
  armed = false;
  EXPECT_TRUE(done);
  EXPECT_TRUE(std::isfinite(energy));
  EXPECT_EQ(allocations, 0);
}

}  // namespace
}  // namespace knee_robot::dynamics
