// Chains: recordings in their own units, a known arm found again, drive gains, and the public recordings where they are
// at hand.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "knee_robot/base/errors.h"
#include "knee_robot/identification/drive_gains.h"
#include "knee_robot/identification/evaluation.h"
#include "knee_robot/identification/identify.h"
#include "knee_robot/identification/prediction.h"
#include "knee_robot/identification/recording_units.h"
#include "test/identification/chain_motion.h"

namespace knee_robot::identification {
namespace {

namespace fs = std::filesystem;

class ChainTest : public testing::Test {
 protected:
  mechanism::Robot robot(const std::string& urdf, const std::string& base, const std::string& tip,
                         const std::string& more = "") {
    std::ofstream(folder_ / "robot.yaml") << "mechanism: chain\nurdf: " << fs::absolute(urdf).string()
                                          << "\nbase_link: " << base << "\ntip_link: " << tip << "\n"
                                          << more;
    return mechanism::loadAnyRobot((folder_ / "robot.yaml").string());
  }
  mechanism::Robot arm() { return robot(KNEE_SOURCE_DIR "/test/dynamics/chain.urdf", "base", "tool"); }

  const TemporaryFolder folder_;
};

Observation seen(mechanism::Robot& robot, recording::Recording r, const ObservationOptions& options) {
  toActuatorUnits(robot, r);
  return observe(robot, columnsOf(robot), r, options);
}

TEST_F(ChainTest, AKnownArmIsFoundAgainInItsOwnUnits) {
  mechanism::Robot robot = arm();
  IdentifyOptions options;
  options.uncertainty = false;
  std::vector<Observation> training = {seen(robot, armRecording(robot, 1), options.observation)};
  const Identification id = identify(robot, training, options);
  const Applied held_out = applyModel(id.model, robot, {seen(robot, armRecording(robot, 2), options.observation)}, 3.0);
  EXPECT_LT(held_out.accuracy.togetherPercent(), 1.0);
  for (const dynamics::ModelParameter& p : id.model.parameters) {
    if (p.name != "Fv_2" && p.name != "Fc_2") continue;
    EXPECT_NEAR(p.value, p.name == "Fv_2" ? kViscous : kDry, 0.1) << p.name;
    EXPECT_EQ(p.unit, p.name == "Fv_2" ? "N m s/rad" : "N m");
  }
}

TEST_F(ChainTest, ItsModelFileIsReadAsItWasWritten) {
  mechanism::Robot robot = arm();
  IdentifyOptions options;
  options.uncertainty = false;
  std::vector<Observation> training = {seen(robot, armRecording(robot, 1), options.observation)};
  const dynamics::Model model = identify(robot, training, options).model;
  const std::string text = dynamics::modelToYaml(model);
  EXPECT_NE(text.find("_rad"), std::string::npos) << "friction of revolute joints in rad";
  const dynamics::Model back = dynamics::parseModel(text, "model.yaml");
  const Eigen::MatrixXd one = predictForce(model, robot, training.front().signals, training.front().motion);
  const Eigen::MatrixXd two = predictForce(back, robot, training.front().signals, training.front().motion);
  EXPECT_LT((one - two).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_F(ChainTest, DriveGainsFollowFromAPayloadOfKnownMass) {
  mechanism::Robot robot = arm();
  Eigen::VectorXd gain(6);
  gain << 120.0, 9.0, 12.0, 7.0, 4.0, 5.0;
  ObservationOptions options;
  std::vector<Observation> both;
  for (const double payload_kg : {0.0, 2.5}) {
    recording::Recording r = armRecording(robot, 1, 1.0, nullptr, payload_kg);
    r.current_A = r.force_N * gain.cwiseInverse().asDiagonal();
    r.force_N.resize(r.rows(), 0);
    r.force_unit.clear();
    both.push_back(seen(robot, r, options));
  }
  EXPECT_STREQ(mechanism::forceUnit(robot.actuators[3]), "A") << "nothing but current was recorded";
  const DriveGains found = driveGains(robot, {both[0]}, {both[1]}, 2.5, options);
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(found.gain[i], gain[i], std::max(0.03 * gain[i], 3.0 * found.std[i]))
        << robot.actuators[static_cast<std::size_t>(i)].name;
  EXPECT_LT((found.center_m - kPayloadAt).norm(), 0.01) << found.center_m.transpose();
}

TEST_F(ChainTest, LeavesOutTheColumnsOfLockedJoints) {
  mechanism::Robot all = arm();
  recording::Recording r = armRecording(all, 1);
  for (const int stands : {0, 3, 4, 5})
    r.position_m.col(stands).setConstant(0.2);
  mechanism::Robot two = robot(KNEE_SOURCE_DIR "/test/dynamics/chain.urdf", "base", "tool",
                               "joints: [{name: waist}, {name: shoulder}, {name: roll, locked_at_rad: 0.2}]\n");
  const double torque = r.force_N(7, 1);
  toActuatorUnits(two, r);
  ASSERT_EQ(r.axes, 2);
  EXPECT_NEAR(r.force_N(7, 0) * two.actuators[0].force_per_N(), torque, 1e-12);
}

TEST_F(ChainTest, RefusesColumnsOfAnotherRobot) {
  mechanism::Robot robot = arm();
  const auto refusal = [&](recording::Recording r) -> std::string {
    try {
      toActuatorUnits(robot, r);
    } catch (const InputError& e) {
      return e.what();
    }
    return "accepted";
  };
  recording::Recording turned = armRecording(robot, 1);
  turned.position_unit[0] = "rad";
  EXPECT_NE(refusal(turned).find("joint rail of"), std::string::npos) << refusal(turned);
  recording::Recording pushed = armRecording(robot, 1);
  pushed.force_unit[2] = "N";
  EXPECT_NE(refusal(pushed).find("torque_3_Nm is missing"), std::string::npos) << refusal(pushed);
  recording::Recording fewer = armRecording(robot, 1);
  fewer.axes = 5;
  EXPECT_NE(refusal(fewer).find("records 5 actuators"), std::string::npos) << refusal(fewer);
}

std::string shared(const std::string& name) {
  const char* const given = std::getenv("KNEE_SHARED_DIR");
  return (given != nullptr ? given : std::string(KNEE_SOURCE_DIR) + "/../shared") + "/data/chains/" + name;
}

/// Published: 3.04 % held out; plain least squares with tanh(v / 0.02) reaches 2.59 %.
TEST_F(ChainTest, XMate7IsPredictedOnTheOtherTrajectoryBetterThanByPlainLeastSquares) {
  if (!fs::exists(shared("xmate7p_traj1.csv"))) GTEST_SKIP() << shared("xmate7p_traj1.csv") << " is not here";
  std::string joints = "joints: [";
  for (int i = 1; i <= 7; ++i)
    joints += "{name: joint" + std::to_string(i) + ", resolution_rad: 1.0e-6}" + (i < 7 ? ", " : "]\n");
  mechanism::Robot robot = this->robot(shared("xmate7p.urdf"), "base_link", "link7", joints);
  IdentifyOptions options;
  options.uncertainty = false;
  std::vector<Observation> training = {
      seen(robot, recording::loadRecording(shared("xmate7p_traj1.csv")), options.observation)};
  const Identification id = identify(robot, training, options);
  const Observation other = seen(robot, recording::loadRecording(shared("xmate7p_traj2.csv")), options.observation);
  const Accuracy a = applyModel(id.model, robot, {other}, options.observation.cutoff_hz).accuracy;
  std::cout << "all joints together " << a.togetherPercent() << " %, each " << a.rms_percent.transpose() << " %\n";
  EXPECT_LT(a.togetherPercent(), 2.6);
}

}  // namespace
}  // namespace knee_robot::identification
