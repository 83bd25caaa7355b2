// Robot files with `mechanism: chain`: what they and their URDFs may say, and one sentence for what they may not.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::mechanism {
namespace {

namespace fs = std::filesystem;

const char* const kArm = KNEE_SOURCE_DIR "/test/dynamics/chain.urdf";

/// Robot file and URDF in a folder of their own, removed afterwards.
class ChainFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("chain_file_test_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    urdf_ = readFile(kArm);
  }
  void TearDown() override { fs::remove_all(folder_); }

  Robot load(const std::string& more = "", const std::string& base = "base", const std::string& tip = "tool") {
    std::ofstream(folder_ / "arm.urdf") << urdf_;
    std::ofstream(folder_ / "robot.yaml")
        << "mechanism: chain\nurdf: arm.urdf\nbase_link: " << base << "\ntip_link: " << tip << "\n"
        << more;
    return loadAnyRobot((folder_ / "robot.yaml").string());
  }

  /// The refusal, which names the words in it.
  void refuses(const std::vector<std::string>& words, const std::string& more = "", const std::string& base = "base",
               const std::string& tip = "tool") {
    try {
      load(more, base, tip);
      ADD_FAILURE() << "accepted; expected a refusal about " << words.front();
    } catch (const InputError& e) {
      const std::string said = e.what();
      for (const std::string& word : words)
        EXPECT_NE(said.find(word), std::string::npos) << said;
      EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    }
  }

  void replace(const std::string& from, const std::string& to) {
    const std::size_t at = urdf_.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    urdf_.replace(at, from.size(), to);
  }

  fs::path folder_;
  std::string urdf_;
};

TEST_F(ChainFile, TakesEveryMovingJointBetweenBaseAndTip) {
  const Robot robot = load();
  ASSERT_EQ(robot.axes(), 6);
  EXPECT_EQ(robot.kind, MechanismKind::Chain);
  EXPECT_EQ(robot.actuators[0].name, "rail");
  EXPECT_STREQ(positionUnit(robot.actuators[0]), "m");
  EXPECT_STREQ(forceUnit(robot.actuators[0]), "N");
  EXPECT_STREQ(positionUnit(robot.actuators[1]), "rad");
  EXPECT_STREQ(forceUnit(robot.actuators[1]), "Nm");
  EXPECT_NEAR(robot.actuators[1].position_max_m, 2.9 * kJointRadius_m, 1e-12) << "the URDF's limit";
  EXPECT_EQ(robot.chain->joints.back().links.size(), 3u) << "wrist, the tool fixed to it, the finger beside the chain";
}

TEST_F(ChainFile, IsRefusedWhereOnlyAParallelRobotOrAxesWillDo) {
  load();
  EXPECT_THROW(loadRobot((folder_ / "robot.yaml").string()), InputError);
}

TEST_F(ChainFile, FoldsLockedJointsIntoTheBodyThatCarriesThem) {
  const Robot robot =
      load("joints: [{name: waist}, {name: shoulder}, {name: elbow, locked_at_rad: 0.5}, {name: roll}]\n");
  ASSERT_EQ(robot.axes(), 3);
  EXPECT_EQ(robot.actuators[2].name, "roll");
  EXPECT_EQ(robot.chain->joints[1].links.size(), 2u) << "upper arm and forearm";
}

TEST_F(ChainFile, ReadsEncoderStepLimitsAndDriveGain) {
  const Robot robot = load(
      "joints: [{name: waist, counts_per_revolution: 8192, torque_per_ampere_Nm: 11.5, position_min_rad: -1, "
      "position_max_rad: 1.5, velocity_max_rad_per_s: 0.7}]\n");
  const Actuator& waist = robot.actuators.front();
  EXPECT_NEAR(waist.metresPerCount() * waist.position_per_m(), 2.0 * M_PI / 8192, 1e-12);
  EXPECT_STREQ(forceUnit(waist), "A") << "a gain says that current was recorded";
  EXPECT_NEAR(1.0 / waist.force_per_N() * kJointRadius_m, 11.5, 1e-12) << "N m per ampere";
  EXPECT_NEAR(waist.velocity_max_m_per_s * waist.position_per_m(), 0.7, 1e-12);
}

TEST_F(ChainFile, RefusesALoop) {
  replace("</robot>",
          "<joint name=\"strut\" type=\"revolute\"><parent link=\"base\"/><child link=\"fore\"/><axis xyz=\"0 0 1\"/>"
          "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint></robot>");
  refuses({"arm.urdf", "fore", "strut", "loop"});
}

TEST_F(ChainFile, RefusesWhatIsNoUrdf) {
  urdf_ = "<sdf/>";
  refuses({"arm.urdf", "not a URDF"});
}

TEST_F(ChainFile, RefusesAMovingBodyWithoutInertia) {
  const std::size_t from = urdf_.find("<inertial>", urdf_.find("link name=\"tower\""));
  urdf_.erase(from, urdf_.find("</inertial>", from) + 11 - from);
  refuses({"arm.urdf", "tower", "waist", "<inertial>"});
}

TEST_F(ChainFile, RefusesAnInertiaThatNoLinkHas) {
  const std::size_t at = urdf_.find("<mass value=\"", urdf_.find("link name=\"tower\""));
  urdf_.replace(at + 13, 3, "9e300");
  refuses({"arm.urdf", "tower", "mass"});
}

TEST_F(ChainFile, RefusesALockedJointThatFollowsAMovingOne) {
  replace("<joint name=\"finger_joint\" type=\"prismatic\">",
          "<joint name=\"finger_joint\" type=\"prismatic\"><mimic joint=\"pitch\"/>");
  refuses({"arm.urdf", "finger_joint", "pitch", "mimic"});
  EXPECT_EQ(load("joints: [{name: waist}, {name: finger_joint, locked_at_m: 0.01}]\n").axes(), 1);
}

TEST_F(ChainFile, RefusesLinksThatAreNotOnOneBranch) {
  refuses({"nowhere", "base_link"}, "", "nowhere");
  refuses({"tool", "finger"}, "", "finger", "tool");
}

TEST_F(ChainFile, RefusesJointsThatTheChainDoesNotHave) {
  refuses({"knee", "joints"}, "joints: [{name: knee}]\n");
  refuses({"flange", "neither revolute"}, "joints: [{name: flange}]\n");
  refuses({"finger_joint", "not between"}, "joints: [{name: finger_joint}]\n");
  refuses({"waist", "twice"}, "joints: [{name: waist}, {name: waist}]\n");
  refuses({"robot.yaml", "order"}, "joints: [{name: shoulder}, {name: waist}]\n");
}

TEST_F(ChainFile, RefusesKeysThatDoNotBelong) {
  refuses({"robot.yaml:5", "colour"}, "colour: red\n");
  refuses({"robot.yaml:5", "resolution_m"}, "joints: [{name: waist, resolution_m: 0.1}]\n");
  refuses({"robot.yaml:5", "actuators"}, "actuators: []\n");
}

TEST_F(ChainFile, RefusesAJointThatIsNeitherFixedNorSingle) {
  replace("name=\"elbow\" type=\"revolute\"", "name=\"elbow\" type=\"floating\"");
  refuses({"arm.urdf", "elbow", "floating"});
}

TEST_F(ChainFile, AMomentThatIsNoNumberIsRefusedByItsLink) {
  const std::size_t at = urdf_.find("ixx=\"");
  ASSERT_NE(at, std::string::npos);
  for (const char* word : {"nan", "inf", "1,5"}) {
    const std::string good = urdf_;
    urdf_.replace(at, urdf_.find('"', at + 5) - at, std::string("ixx=\"") + word);
    refuses({"arm.urdf", "link ", "<inertial> cannot be read", "ixx"});
    urdf_ = good;
  }
}

TEST_F(ChainFile, JointsMayHaveNamesThatYamlWouldTakeForSomethingElse) {
  const std::string good = urdf_;
  const std::string old = load().actuators.front().name;
  for (const std::string name : {"a #b", "x: y", "[a]", "{", "'", "- a"}) {
    urdf_ = good;
    for (std::size_t at = 0; (at = urdf_.find("\"" + old + "\"", at)) != std::string::npos; at += name.size())
      urdf_.replace(at + 1, old.size(), name);
    EXPECT_EQ(load().actuators.front().name, name);
  }
  urdf_ = good;
  replace("<joint name=\"" + old + "\"", "<joint name=\"\"");
  refuses({"arm.urdf", "the joint above link ", "is named ''"});
}

}  // namespace
}  // namespace knee_robot::mechanism
