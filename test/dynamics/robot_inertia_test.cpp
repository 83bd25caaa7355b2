#include "knee_robot/dynamics/robot_inertia.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "test/refusal.h"

namespace knee_robot::dynamics {
namespace {

namespace fs = std::filesystem;

mechanism::Robot configured(const std::string& name) {
  return mechanism::loadRobot(std::string(KNEE_SOURCE_DIR) + "/config/robots/" + name + ".yaml");
}

/// The final robot with a changed copy of its URDF.
class RobotInertiaFile : public testing::Test {
 protected:
  void SetUp() override {
    robot_ = configured("final");
    text_ = readFile(robot_.urdf);
    robot_.urdf = (fs::temp_directory_path() / ("robot_inertia_test_" + std::to_string(::getpid()) + ".urdf")).string();
  }
  void TearDown() override { fs::remove(robot_.urdf); }
  /// Replaces the first `from` after `anchor`.
  void replace(const std::string& anchor, const std::string& from, const std::string& to) {
    const std::size_t at = text_.find(from, text_.find(anchor));
    ASSERT_NE(at, std::string::npos);
    text_.replace(at, from.size(), to);
  }
  std::string refusal() {
    std::ofstream(robot_.urdf) << text_;
    return refusalOf([&] { loadRobotInertia(robot_); });
  }
  mechanism::Robot robot_;
  std::string text_;
};

TEST(RobotInertia, OfEveryConfiguredRobotLoads) {
  for (const char* name : {"final", "starting", "A", "B"}) {
    const RobotInertia inertia = loadRobotInertia(configured(name));
    double mass = 0.0;
    for (const LinkInertia& link : inertia.links)
      mass += link.mass;
    EXPECT_NEAR(mass, 4 * (2.5 + 0.8) + 9.0, 1e-9) << name;
    EXPECT_TRUE(inertia.rotor_mass.isZero());
  }
}

TEST_F(RobotInertiaFile, RespectsTheInertialOriginsTurn) {
  // Turned by 90 deg about z, the tensor's x and y change places; the centre of mass stays.
  const LinkInertia before = loadRobotInertia(configured("final")).links[kPlatformLink];
  replace("link name=\"platform\"", "rpy=\"0 0 0\"", "rpy=\"0 0 1.5707963267948966\"");
  replace("link name=\"platform\"", "iyy=\"", "iyy=\"1");  // make x and y differ: 0.2... becomes 10.2...
  std::ofstream(robot_.urdf) << text_;
  const std::string said = refusalOf([&] { loadRobotInertia(robot_); });
  EXPECT_NE(said.find("link platform has an impossible inertia"), std::string::npos);
  replace("link name=\"platform\"", "iyy=\"1", "iyy=\"");
  replace("link name=\"platform\"", "ixy=\"0\"", "ixy=\"0.05\"");
  std::ofstream(robot_.urdf) << text_;
  const LinkInertia after = loadRobotInertia(robot_).links[kPlatformLink];
  EXPECT_NEAR(after.inertia(0, 1), -0.05, 1e-12);  // a quarter turn changes the sign of Ixy
  EXPECT_TRUE(after.center.isApprox(before.center, 1e-15));
}

TEST_F(RobotInertiaFile, NamesTheLinkThatNoBodyCanBe) {
  replace("link name=\"leg_2_rod\"", "<mass value=\"0.8\"/>", "<mass value=\"-0.8\"/>");
  EXPECT_NE(refusal().find("leg_2_rod has an impossible inertia: mass -0.8 kg"), std::string::npos);
}

TEST_F(RobotInertiaFile, NamesTheJointThatTheGeometryPutsElsewhere) {
  replace("joint name=\"q21\"", "xyz=\"0 0.4 0\"", "xyz=\"0 0.400002 0\"");
  EXPECT_NE(refusal().find("joint q21 is 2e-06 m from where"), std::string::npos);
}

TEST_F(RobotInertiaFile, AcceptsWhatIsWithinAMicrometre) {
  replace("joint name=\"q21\"", "xyz=\"0 0.4 0\"", "xyz=\"0 0.4000005 0\"");
  EXPECT_EQ(refusal(), "");
}

TEST_F(RobotInertiaFile, NamesAMissingLinkAndAFileThatIsNoUrdf) {
  text_ = "<robot name=\"r\"><link name=\"base\"/></robot>";
  EXPECT_NE(refusal().find("link leg_1_cylinder is missing"), std::string::npos);
  text_ = "not a robot";
  EXPECT_NE(refusal().find("not a URDF"), std::string::npos);
}

TEST(RobotInertia, NeedsAUrdf) {
  mechanism::Robot robot = configured("final");
  robot.urdf.clear();
  EXPECT_THROW(loadRobotInertia(robot), InputError);
}

TEST(RigidBody, ConvertsToParametersAboutTheOriginAndBack) {
  LinkInertia link;
  link.mass = 2.0;
  link.center = mechanism::Vector3(0.1, -0.2, 0.3);
  link.inertia << 0.05, 0.001, 0.002, 0.001, 0.06, 0.003, 0.002, 0.003, 0.07;
  const LinkParameters p = toParameters(link);
  EXPECT_NEAR(p[0], 0.05 + 2.0 * (0.04 + 0.09), 1e-15);  // Ixx
  EXPECT_NEAR(p[1], 0.001 + 2.0 * 0.02, 1e-15);          // Ixy: -m x y
  EXPECT_NEAR(p[6], 0.2, 1e-15);                         // mX
  const LinkInertia back = fromParameters(p);
  EXPECT_LT((back.inertia - link.inertia).norm(), 1e-15);
  EXPECT_LT((back.center - link.center).norm(), 1e-15);
}

TEST(RigidBody, SaysWhyAnInertiaIsImpossible) {
  LinkInertia link{1.0, mechanism::Vector3::Zero(), mechanism::Vector3(1, 1, 1.5).asDiagonal()};
  EXPECT_EQ(inconsistency(link), "");
  link.inertia = mechanism::Vector3(1, 1, 2.1).asDiagonal();  // larger than the sum of the others
  EXPECT_NE(inconsistency(link).find("exceeds the sum"), std::string::npos);
  link.inertia = mechanism::Vector3(-0.1, 1, 1).asDiagonal();
  EXPECT_NE(inconsistency(link).find("negative"), std::string::npos);
  link = {0.0, mechanism::Vector3::Zero(), mechanism::Matrix3::Identity()};
  EXPECT_NE(inconsistency(link).find("mass 0"), std::string::npos);
}

}  // namespace
}  // namespace knee_robot::dynamics
