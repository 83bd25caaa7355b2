#include "knee_robot/dynamics/urdf_inertia.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/dynamics/pseudo_inertia.h"
#include "test/mechanism/configured_robot.h"
#include "test/temporary_folder.h"

namespace knee_robot::dynamics {
namespace {

mechanism::Robot finalRobot() {
  return mechanism::configuredRobot("final");
}

TEST(PseudoInertia, IsInvertedExactlyAndPositiveForBodiesThatExist) {
  const RobotInertia robot = loadRobotInertia(finalRobot());
  for (const LinkInertia& body : robot.links) {
    const LinkParameters p = toParameters(body);
    const mechanism::Matrix4 j = pseudoInertia(p);
    EXPECT_LT((parametersOfPseudoInertia(j) - p).norm(), 1e-14);
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<mechanism::Matrix4>(j).eigenvalues()[0], -1e-12);
  }
}

TEST(PseudoInertia, IsIndefiniteWhereThePrincipalMomentsBreakTheTriangleInequality) {
  LinkInertia body;
  body.mass = 2.0;
  body.center = mechanism::Vector3(0.1, -0.2, 0.05);
  body.inertia = mechanism::Vector3(0.01, 0.02, 0.04).asDiagonal();
  EXPECT_LT(Eigen::SelfAdjointEigenSolver<mechanism::Matrix4>(pseudoInertia(toParameters(body))).eigenvalues()[0], 0.0);
  body.inertia(2, 2) = 0.029;
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<mechanism::Matrix4>(pseudoInertia(toParameters(body))).eigenvalues()[0], 0.0);
}

TEST(UrdfWithInertia, IsReadBackAsItWasWritten) {
  mechanism::Robot robot = finalRobot();
  RobotInertia inertia = loadRobotInertia(robot);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0.7, 1.3);
  for (LinkInertia& body : inertia.links) {
    body.mass *= uniform(random);
    body.center += mechanism::Vector3(0.001, -0.002, 0.003) * uniform(random);
    body.inertia *= uniform(random);
  }
  mechanism::Matrix3& platform = inertia.links[kPlatformLink].inertia;
  platform(0, 1) = platform(1, 0) = 0.05 * platform(0, 0);
  const TemporaryFolder folder;
  const std::string path = folder + "/identified.urdf";
  writeFileAtomically(path, urdfWithInertia(robot.urdf, inertia, "a note"));
  const std::string text = readFile(path);
  EXPECT_NE(text.find("a note"), std::string::npos);
  EXPECT_NE(text.find("<visual>"), std::string::npos) << "everything else stays";
  robot.urdf = path;
  const RobotInertia back = loadRobotInertia(robot);
  EXPECT_LT((toParameters(back) - toParameters(inertia)).norm(), 1e-12);
}

TEST(UrdfWithInertia, NeverWritesWhatNoBodyCanHave) {
  const mechanism::Robot robot = finalRobot();
  RobotInertia inertia = loadRobotInertia(robot);
  inertia.links[3].mass = -1.0;
  EXPECT_THROW(urdfWithInertia(robot.urdf, inertia, ""), std::invalid_argument);
  EXPECT_THROW(urdfWithInertia(robot.path, loadRobotInertia(robot), ""), InputError) << "a YAML file is no URDF";
}

}  // namespace
}  // namespace knee_robot::dynamics
