// Files that fit each other in form and not the machine: signs, units and lines that were entered wrongly at commissioning.
#include <filesystem>
#include <regex>
#include <tuple>

#include "files_of_a_robot.h"
#include "knee_robot/base/files.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

using namespace mistaken;

/// `text` with another value of the n-th `key`.
std::string with(std::string text, const std::string& key, int n, const std::string& value) {
  std::size_t at = std::string::npos;
  for (int i = 0; i < n; ++i)
    at = text.find(key + ": ", at + 1);
  const std::size_t from = at + key.size() + 2;
  return text.replace(from, text.find_first_of(",}\n", from) - from, value);
}

class CommissioningMistake : public ::testing::Test {
 protected:
  CommissioningMistake() {
    const std::string urdf = std::filesystem::absolute(holding::file("urdf/A.urdf")).string();
    robot = std::regex_replace(readFile(Files().robot), std::regex("urdf: \\S+"), "urdf: " + urdf);
    hardware = readFile(Files().hardware);
  }
  Outcome outcome() {
    Files files;
    files.robot = folder + "/robot.yaml";
    files.hardware = folder + "/hardware.yaml";
    writeFileAtomically(files.robot, robot);
    writeFileAtomically(files.hardware, hardware);
    return outcomeOf(files);
  }
  void turnRound(int axis) {
    for (const char* sign : {"encoder_sign", "force_sign"})
      robot = with(robot, sign, axis, "-1");
  }
  void wire(int drive_enable, int hold_release, int heartbeat) {
    hardware = with(hardware, "drive_enable", 1, std::to_string(drive_enable));
    hardware = with(hardware, "hold_release", 1, std::to_string(hold_release));
    hardware = with(hardware, "heartbeat", 1, std::to_string(heartbeat));
  }
  const TemporaryFolder folder;
  std::string robot, hardware;
};

/// Whoever has found a wrong encoder_sign by its runaway, and then changed force_sign, has closed the loop again: the leg
/// went by 10 mm in the other direction, and nothing was said.
TEST_F(CommissioningMistake, BothSignsOfTheLegThatCarriesAreFoundByItsWeightBeforeItMoves) {
  turnRound(4);
  const Outcome now = outcome();
  EXPECT_EQ(now.fault, "weight_opposite at enabling");
  EXPECT_LT(now.leg_m, 0.005);  // where the brakes open
  EXPECT_TRUE(now.ends_off);
}

TEST_F(CommissioningMistake, AllSignsAreFoundByTheWeight) {
  for (int axis = 1; axis <= 4; ++axis)
    turnRound(axis);
  const Outcome now = outcome();
  EXPECT_EQ(now.fault, "weight_opposite at enabling");
  EXPECT_LT(now.leg_m, 0.005);
}

TEST_F(CommissioningMistake, GravityUpwardsIsFoundByTheWeight) {
  robot = std::regex_replace(robot, std::regex("-9.81"), "9.81");
  const Outcome now = outcome();
  EXPECT_EQ(now.fault, "weight_opposite at enabling");
  EXPECT_LT(now.leg_m, 0.005);
}

TEST_F(CommissioningMistake, OneSignIsARunawayWithinMillimetres) {
  const std::string right = robot;
  for (const char* sign : {"encoder_sign", "force_sign"}) {
    for (int axis = 1; axis <= 4; ++axis) {
      robot = with(right, sign, axis, "-1");
      const Outcome now = outcome();
      EXPECT_EQ(now.fault.substr(0, 7), "runaway") << sign << axis;
      EXPECT_LT(now.leg_m, 0.02) << sign << axis;
    }
  }
}

/// With a hundredth of the true lead, or a hundred times the true counts, a leg went 397 mm on a path of 10 mm; 103 mm with
/// a tenth of the lead.
TEST_F(CommissioningMistake, LeadsAndCountsThatNoMachineHasAreRefused) {
  const std::string right = robot;
  for (const auto& [key, axis, value] : std::vector<std::tuple<const char*, int, const char*>>{
           {"screw_lead_m", 1, "0.002"}, {"screw_lead_m", 4, "0.000465"}, {"counts_per_revolution", 2, "100000"}}) {
    robot = with(right, key, axis, value);
    const Outcome now = outcome();
    EXPECT_NE(now.refusal.find("correct screw_lead_m"), std::string::npos) << key << axis << ": " << now.refusal;
  }
}

TEST_F(CommissioningMistake, OutputsThatHaveChangedPlacesEndBeforeThePlatformHasSunkFar) {
  for (const auto& [drive_enable, hold_release, heartbeat] :
       std::vector<std::array<int, 3>>{{1, 0, 2}, {0, 2, 1}, {2, 1, 0}, {1, 2, 0}, {2, 0, 1}, {3, 1, 2}, {0, 3, 2}}) {
    wire(drive_enable, hold_release, heartbeat);
    const Outcome now = outcome();
    EXPECT_NE(now.fault.find(" at enabling"), std::string::npos) << drive_enable << hold_release << heartbeat;
    EXPECT_LT(now.leg_m, 0.01) << drive_enable << hold_release << heartbeat;
  }
}

/// Of what nobody declared, and of what was declared and is not there.
TEST(WeightOfTheCarryingLeg, IsNotDoubtedForAnotherLoad) {
  for (const double payload_kg : {0.0, 5.0, 15.0}) {
    holding::Truth truth;
    truth.payload_kg = payload_kg;
    holding::HoldingRobot robot(truth);
    EXPECT_EQ(robot.system->state(), MachineState::Holding) << payload_kg << robot.system->status().fault_sentence;
  }
  holding::Truth crane;
  crane.carried = true;
  holding::HoldingRobot robot(crane);
  EXPECT_EQ(robot.system->state(), MachineState::Holding) << robot.system->status().fault_sentence;
}

}  // namespace
}  // namespace knee_robot::control
