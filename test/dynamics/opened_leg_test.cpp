// Each opened leg of the linear model against KDL's recursive Newton-Euler on the same URDF.
#include <gtest/gtest.h>

#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl_parser/kdl_parser.hpp>

#include "knee_robot/dynamics/regressor.h"
#include "knee_robot/dynamics/robot_inertia.h"
#include "test/dynamics/random_robots.h"

namespace knee_robot::dynamics {
namespace {

class OpenedLeg : public testing::TestWithParam<const char*> {};

TEST_P(OpenedLeg, NeedsTheForcesThatKdlComputes) {
  const mechanism::Robot robot =
      mechanism::loadRobot(std::string(KNEE_SOURCE_DIR) + "/config/robots/" + GetParam() + ".yaml");
  const RobotInertia inertia = loadRobotInertia(robot);
  KDL::Tree tree;
  ASSERT_TRUE(kdl_parser::treeFromFile(robot.urdf, tree));
  const mechanism::Vector3 gravity(0.5, -0.7, -9.7);
  mechanism::RandomPoses random(51);
  for (int i = 0; i < mechanism::kLegs; ++i) {
    KDL::Chain chain;
    ASSERT_TRUE(tree.getChain("base", "leg_" + std::to_string(i + 1) + "_rod", chain));
    const int joints = i == 3 ? 2 : 3;
    ASSERT_EQ(static_cast<int>(chain.getNrOfJoints()), joints);
    KDL::ChainIdSolver_RNE solver(chain, KDL::Vector(gravity.x(), gravity.y(), gravity.z()));
    Eigen::Matrix<double, 2 * kLinkParameters, 1> parameters;
    parameters << toParameters(inertia.links[cylinderLink(i)]), toParameters(inertia.links[rodLink(i)]);
    for (int k = 0; k < 500; ++k) {
      const mechanism::Motion motion = randomMotion(random, *robot.mechanism, 1.0, 5.0);
      RegressorData data;
      ASSERT_TRUE(projectedRegressor(*robot.mechanism, gravity, motion, data));
      const auto values = mechanism::urdfJointPositions(*robot.mechanism, motion.pose);
      KDL::JntArray q(joints), v(joints), a(joints), torque(joints);
      for (int j = 0; j < joints; ++j) {
        const int row = i == 3 ? j + 1 : j;  // leg 4 has no q1
        q(j) = values[3 * i + j];
        v(j) = data.motion.legs[i].rate[row];
        a(j) = data.motion.legs[i].acceleration[row];
      }
      ASSERT_EQ(solver.CartToJnt(q, v, a, KDL::Wrenches(chain.getNrOfSegments(), KDL::Wrench::Zero()), torque), 0);
      const mechanism::Vector3 ours = data.leg[i] * parameters;
      for (int j = 0; j < joints; ++j)
        EXPECT_NEAR(ours[i == 3 ? j + 1 : j], torque(j), 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BothGeometries, OpenedLeg, testing::Values("final", "starting"));

}  // namespace
}  // namespace knee_robot::dynamics
