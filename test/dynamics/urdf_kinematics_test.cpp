// The URDF drawn with urdfJointPositions closes its loops: KDL's forward kinematics against the robot's own.
#include <gtest/gtest.h>

#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl_parser/kdl_parser.hpp>

#include "knee_robot/mechanism/leg_motion.h"
#include "knee_robot/mechanism/robot.h"
#include "test/mechanism/random_poses.h"

namespace knee_robot::dynamics {
namespace {

/// KDL's placement of `link` at the joint values of `pose`.
KDL::Frame placement(const KDL::Tree& tree, const std::string& link, const mechanism::Mechanism& mechanism,
                     const mechanism::Pose& pose) {
  KDL::Chain chain;
  EXPECT_TRUE(tree.getChain("base", link, chain));
  const auto values = mechanism::urdfJointPositions(mechanism, pose);
  KDL::JntArray joints(chain.getNrOfJoints());
  unsigned filled = 0;
  for (const KDL::Segment& segment : chain.segments) {
    for (int k = 0; k < mechanism::kUrdfJoints; ++k) {
      if (segment.getJoint().getName() == mechanism::urdfJointNames()[k]) joints(filled++) = values[k];
    }
  }
  EXPECT_EQ(filled, joints.rows());
  KDL::Frame frame;
  KDL::ChainFkSolverPos_recursive(chain).JntToCart(joints, frame);
  return frame;
}

mechanism::Vector3 position(const KDL::Frame& frame) {
  return {frame.p.x(), frame.p.y(), frame.p.z()};
}

class Urdf : public testing::TestWithParam<const char*> {};

TEST_P(Urdf, ClosesItsLoopsAtRandomPoses) {
  const mechanism::Robot robot =
      mechanism::loadRobot(std::string(KNEE_SOURCE_DIR) + "/config/robots/" + GetParam() + ".yaml");
  KDL::Tree tree;
  ASSERT_TRUE(kdl_parser::treeFromFile(robot.urdf, tree));
  mechanism::RandomPoses random(21);
  for (int k = 0; k < 200; ++k) {
    const mechanism::Pose pose = random.pose(*robot.mechanism);
    const KDL::Frame platform = placement(tree, "platform", *robot.mechanism, pose);
    EXPECT_LT((position(platform) - mechanism::Vector3(pose[0], 0.0, pose[1])).norm(), 1e-12);
    const mechanism::Matrix3 rotation = mechanism::platformRotation(pose);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        EXPECT_NEAR(platform.M(row, column), rotation(row, column), 1e-12);
    }
    for (int leg = 1; leg <= 3; ++leg) {
      const KDL::Frame tip = placement(tree, "leg_" + std::to_string(leg) + "_rod", *robot.mechanism, pose);
      const KDL::Frame joint = placement(tree, "platform_point_" + std::to_string(leg), *robot.mechanism, pose);
      EXPECT_LT((position(tip) - position(joint)).norm(), 1e-12) << "leg " << leg;
    }
  }
}

TEST_P(Urdf, HasTheLegBasisAsTheFramesOfCylinderAndRod) {
  const mechanism::Robot robot =
      mechanism::loadRobot(std::string(KNEE_SOURCE_DIR) + "/config/robots/" + GetParam() + ".yaml");
  KDL::Tree tree;
  ASSERT_TRUE(kdl_parser::treeFromFile(robot.urdf, tree));
  mechanism::RandomPoses random(22);
  for (int k = 0; k < 50; ++k) {
    mechanism::Motion still;
    still.pose = random.pose(*robot.mechanism);
    mechanism::RobotMotion motion;
    mechanism::robotMotion(*robot.mechanism, still, motion);
    for (int i = 0; i < mechanism::kLegs; ++i) {
      const mechanism::LegMotion& leg = motion.legs[i];
      const std::string name = "leg_" + std::to_string(i + 1) + "_";
      const KDL::Frame cylinder = placement(tree, name + "cylinder", *robot.mechanism, still.pose);
      const KDL::Frame rod = placement(tree, name + "rod", *robot.mechanism, still.pose);
      for (int row = 0; row < 3; ++row) {
        EXPECT_NEAR(cylinder.M(row, 0), -leg.t[row], 1e-12);
        EXPECT_NEAR(cylinder.M(row, 1), leg.u[row], 1e-12);
        EXPECT_NEAR(cylinder.M(row, 2), leg.n[row], 1e-12);
        EXPECT_NEAR(rod.M(row, 1), -leg.n[row], 1e-12);
        EXPECT_NEAR(rod.M(row, 2), leg.u[row], 1e-12);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EveryRobot, Urdf, testing::Values("final", "starting", "A", "B"));

}  // namespace
}  // namespace knee_robot::dynamics
