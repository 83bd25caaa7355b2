#include "src/control/disturbance_classifier.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "some_model.h"
#include "test/mechanism/configured_robot.h"

namespace knee_robot::control {
namespace {

/// What is said of a robot in motion that carries 98.1 N more than its model knows.
DisturbanceClassifier::Verdict carryingMore(double gravity_m_per_s2) {
  mechanism::Robot robot = mechanism::configuredRobot("A");
  robot.gravity = {0.0, 0.0, -gravity_m_per_s2};
  const ForceKnowledge knowledge(fake::modelOf(robot), robot);
  mechanism::Lengths home;
  for (std::size_t i = 0; i < 4; ++i)
    home[static_cast<Eigen::Index>(i)] = robot.actuators[i].home_length_m;
  ResidualEstimator::Estimate now;
  now.known = true;
  now.pose = mechanism::forwardKinematicsFromHome(*robot.mechanism, home).pose;
  now.jacobian = mechanism::lengthJacobian(*robot.mechanism, now.pose);
  now.moving.setOnes();
  now.wrench = mechanism::Vector4(0.0, -98.1, 0.0, 0.0);
  now.residual_N = now.certain_N = -now.jacobian.transpose().partialPivLu().solve(now.wrench);
  DisturbanceClassifier classifier;
  for (int k = 0; k < 4000; ++k)
    classifier.step(knowledge, now, 0.001);
  return classifier.verdict();
}

TEST(DisturbanceClassifier, SaysTheMassOfALoadByTheGravityOfTheRobotFile) {
  EXPECT_TRUE(carryingMore(9.81).carries);
  EXPECT_NEAR(carryingMore(9.81).load_kg, 10.0, 1e-6);
  EXPECT_NEAR(carryingMore(4.905).load_kg, 20.0, 1e-6);
  EXPECT_EQ(carryingMore(0.0).load_kg, 0.0) << "nothing weighs";
}

}  // namespace
}  // namespace knee_robot::control
