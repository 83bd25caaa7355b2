#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "knee_robot/base/errors.h"
#include "knee_robot/mechanism/robot.h"
#include "test/refusal.h"

namespace knee_robot::mechanism {
namespace {

namespace fs = std::filesystem;

const char* const kGeometry =
    "geometry: {R_m: [0.4, 0.4, 0.4], ds_m: 0.15, beta_FD_deg: 90, beta_FI_deg: 45, Rm_m: [0.3, 0.3, 0.3], "
    "beta_MD_deg: 50, beta_MI_deg: 90}\n";
const char* const kActuator =
    "{position_min_m: 0.6, position_max_m: 0.9, velocity_max_m_per_s: 0.2, acceleration_max_m_per_s2: 5, "
    "screw_lead_m: 0.010, counts_per_revolution: 2000";

std::string parallel(const std::string& actuator_rest = "}", const std::string& more = "") {
  return std::string("mechanism: 3UPS+1RPU\n") + kGeometry + "actuators:\n  - " + kActuator + actuator_rest + "\n" +
         more;
}

/// A robot file in a folder of its own, removed afterwards.
class RobotFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("robot_file_test_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string write(const std::string& text, const std::string& name = "robot.yaml") {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::string refusal(const std::string& text) {
    return refusalOf([&] { loadRobot(write(text)); });
  }
  fs::path folder_;
};

TEST_F(RobotFile, FillsTheDocumentedDefaults) {
  const Robot robot = loadRobot(write(parallel()));
  ASSERT_TRUE(robot.mechanism.has_value());
  ASSERT_EQ(robot.axes(), 4);  // one entry stands for all
  const Actuator& a = robot.actuators[3];
  EXPECT_DOUBLE_EQ(a.metresPerCount(), 5e-6);
  EXPECT_EQ(a.encoder_sign, 1);
  EXPECT_DOUBLE_EQ(a.home_length_m, 0.6);
  EXPECT_DOUBLE_EQ(a.force_per_volt_N, 56.8);
  EXPECT_DOUBLE_EQ(a.voltage_max_V, 10.0);
  EXPECT_DOUBLE_EQ(a.force_max_N, 0.0);
  EXPECT_DOUBLE_EQ(robot.gravity.z(), -9.81);
  EXPECT_NEAR(robot.joints.spherical_max, 30 * M_PI / 180, 1e-15);
  EXPECT_DOUBLE_EQ(robot.singularity_condition_max, 60.0);
  EXPECT_EQ(robot.urdf, "");
  EXPECT_NEAR(robot.mechanism->geometry.beta_FD, M_PI / 2, 1e-15);
}

TEST_F(RobotFile, ReadsFourDifferentActuators) {
  std::string text = std::string("mechanism: 3UPS+1RPU\n") + kGeometry + "actuators:\n";
  for (int i = 1; i <= 4; ++i)
    text += std::string("  - ") + kActuator + ", home_length_m: 0.6" + std::to_string(i) + "}\n";
  const Robot robot = loadRobot(write(text));
  EXPECT_DOUBLE_EQ(robot.actuators[2].home_length_m, 0.63);
}

TEST_F(RobotFile, NeedsOnlyActuatorsForBenchAxes) {
  const Robot robot = loadRobot(
      write("mechanism: axes\nactuators:\n  - {position_min_m: -0.1, position_max_m: 0.25, velocity_max_m_per_s: 0.3, "
            "acceleration_max_m_per_s2: 5, screw_lead_m: 0.02, counts_per_revolution: 1000.5}\n"));
  EXPECT_EQ(robot.kind, MechanismKind::Axes);
  EXPECT_FALSE(robot.mechanism.has_value());
  EXPECT_EQ(robot.axes(), 1);
  EXPECT_DOUBLE_EQ(robot.actuators[0].home_length_m, -0.1);
}

TEST_F(RobotFile, NamesFileLineAndKeyOfWhatIsWrong) {
  EXPECT_NE(refusal(parallel("}", "colour: red\n")).find("robot.yaml:5: unknown key colour"), std::string::npos);
  EXPECT_NE(refusal(parallel(", stroke: 1}")).find("unknown key stroke"), std::string::npos);
  EXPECT_NE(refusal(parallel(", encoder_sign: 0}")).find("encoder_sign"), std::string::npos);
  EXPECT_NE(refusal(parallel(", voltage_max_V: -3}")).find("voltage_max_V"), std::string::npos);
  EXPECT_NE(refusal(parallel(", home_length_m: 0.95}")).find("home_length_m"), std::string::npos);
  EXPECT_NE(refusal(parallel(", force_continuous_N: 300, force_max_N: 118}")).find("force_continuous_N"),
            std::string::npos);
  EXPECT_NE(refusal(parallel("}", "urdf: nowhere.urdf\n")).find("nowhere.urdf"), std::string::npos);
  EXPECT_NE(refusal(parallel("}", "singularity_margin: {condition_max: 0.5}\n")).find("condition_max"),
            std::string::npos);
  EXPECT_NE(refusal(parallel("}", "gravity_m_per_s2: [0, 0]\n")).find("gravity_m_per_s2"), std::string::npos);
  EXPECT_NE(refusal("mechanism: 6UPS\n").find("mechanism"), std::string::npos);
  EXPECT_NE(refusal("mechanism: 3UPS+1RPU\nactuators: []\n").find("geometry"), std::string::npos);
  EXPECT_NE(refusal(std::string("mechanism: 3UPS+1RPU\n") + kGeometry + "actuators: []\n").find("0 entries"),
            std::string::npos);
  EXPECT_NE(refusal("").find("robot.yaml"), std::string::npos);
  EXPECT_THROW(loadRobot((folder_ / "absent.yaml").string()), InputError);
}

TEST_F(RobotFile, RefusesAShortestLengthAboveTheLongest) {
  std::string text = parallel();
  text.replace(text.find("position_max_m: 0.9"), 19, "position_max_m: 0.5");
  EXPECT_NE(refusal(text).find("position_max_m: 0.5 must be greater than position_min_m 0.6"), std::string::npos);
}

TEST_F(RobotFile, AcceptsAMarginThatIsWideOpen) {
  EXPECT_TRUE(std::isinf(
      loadRobot(write(parallel("}", "singularity_margin: {condition_max: .inf}\n"))).singularity_condition_max));
}

TEST_F(RobotFile, FindsTheUrdfBesideItselfAndInItsPackage) {
  write("<robot/>", "urdf/r.urdf");
  write("<package><name>some_robot</name></package>", "package.xml");
  EXPECT_EQ(loadRobot(write(parallel("}", "urdf: urdf/r.urdf\n"))).urdf, (folder_ / "urdf/r.urdf").string());
  EXPECT_EQ(loadRobot(write(parallel("}", "urdf: ../urdf/r.urdf\n"), "config/robot.yaml")).urdf,
            (folder_ / "urdf/r.urdf").string());
  EXPECT_EQ(loadRobot(write(parallel("}", "urdf: package://some_robot/urdf/r.urdf\n"), "config/robot.yaml")).urdf,
            (folder_ / "urdf/r.urdf").string());
  ::setenv("ROS_PACKAGE_PATH", folder_.c_str(), 1);
  const fs::path elsewhere = folder_ / "elsewhere";
  EXPECT_EQ(loadRobot(write(parallel("}", "urdf: package://some_robot/urdf/r.urdf\n"), "elsewhere/robot.yaml")).urdf,
            (folder_ / "urdf/r.urdf").string());
  EXPECT_NE(refusal(parallel("}", "urdf: package://other/urdf/r.urdf\n")).find("ROS_PACKAGE_PATH"), std::string::npos);
}

TEST_F(RobotFile, RemembersTheFilesFingerprint) {
  const Robot one = loadRobot(write(parallel()));
  const Robot two = loadRobot(write(parallel("}", "# a remark\n")));
  EXPECT_NE(one.fingerprint, two.fingerprint);
}

}  // namespace
}  // namespace knee_robot::mechanism
