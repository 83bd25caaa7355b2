// Drive gains from a payload: what the currents cannot be true of is refused, and the joint or the mass is named.

#include "knee_robot/identification/drive_gains.h"

#include <gtest/gtest.h>

#include "knee_robot/base/errors.h"
#include "knee_robot/identification/recording_units.h"
#include "test/identification/chain_motion.h"

namespace knee_robot::identification {
namespace {

const Eigen::VectorXd kGain = (Eigen::VectorXd(6) << 120.0, 9.0, 12.0, 7.0, 4.0, 5.0).finished();

/// The arm's currents; `signs`: of every joint's column.
Observation currents(mechanism::Robot& robot, int seed, double payload_kg,
                     const Eigen::VectorXd& signs = Eigen::VectorXd::Ones(6)) {
  recording::Recording r = armRecording(robot, seed, 1.0, nullptr, payload_kg);
  r.current_A = r.force_N * kGain.cwiseInverse().cwiseProduct(signs).asDiagonal();
  r.force_N.resize(r.rows(), 0);
  r.force_unit.clear();
  toActuatorUnits(robot, r);
  return observe(robot, columnsOf(robot), r, ObservationOptions());
}

template <typename Action>
std::string whyRefused(const Action& action) {
  try {
    action();
  } catch (const Refusal& refusal) {
    return refusal.what();
  }
  return "";
}

std::string refusal(mechanism::Robot& robot, const std::vector<Observation>& unloaded,
                    const std::vector<Observation>& loaded, double payload_kg) {
  return whyRefused([&] { driveGains(robot, unloaded, loaded, payload_kg, ObservationOptions()); });
}

TEST(DriveGainsOfAChain, ACurrentOfTheWrongSignIsNamed) {
  mechanism::Robot robot = testArm();
  for (const int i : {0, 2, 5}) {
    Eigen::VectorXd signs = Eigen::VectorXd::Ones(6);
    signs[i] = -1.0;
    const std::string said = refusal(robot, {currents(robot, 1, 0.0, signs)}, {currents(robot, 1, 2.5, signs)}, 2.5);
    EXPECT_NE(said.find("joint " + robot.actuators[static_cast<std::size_t>(i)].name + " ("), std::string::npos)
        << i << ": " << said;
    EXPECT_NE(said.find("the gain comes out negative; check the sign of current_" + std::to_string(i + 1) + "_A"),
              std::string::npos)
        << i << ": " << said;
    EXPECT_EQ(said.find(", current"), std::string::npos) << said;
  }
}

TEST(DriveGainsOfAChain, AllCurrentsOfTheWrongSignAreNamed) {
  mechanism::Robot robot = testArm();
  const Eigen::VectorXd signs = Eigen::VectorXd::Constant(6, -1.0);
  const std::string said = refusal(robot, {currents(robot, 1, 0.0, signs)}, {currents(robot, 1, 2.5, signs)}, 2.5);
  EXPECT_NE(said.find("current_1_A, current_2_A, current_3_A, current_4_A, current_5_A, current_6_A"),
            std::string::npos)
      << said;
}

TEST(DriveGainsOfAChain, ByTheUrdfAloneACurrentOfTheWrongSignIsNamedToo) {
  mechanism::Robot robot = testArm();
  Eigen::VectorXd signs = Eigen::VectorXd::Ones(6);
  signs[2] = -1.0;
  const std::vector<Observation> training = {currents(robot, 1, 0.0, signs)};
  const std::string said = whyRefused([&] { gainsByUrdf(robot, training, ObservationOptions()); });
  EXPECT_NE(said.find("check the sign of current_3_A"), std::string::npos) << said;
}

TEST(DriveGainsOfAChain, APayloadThatIsNotThereIsRefused) {
  mechanism::Robot robot = testArm();
  const std::string words = "times what its URDF says";
  const std::string none = refusal(robot, {currents(robot, 1, 0.0)}, {currents(robot, 2, 0.0)}, 2.5);
  EXPECT_NE(none.find(words), std::string::npos) << none;
  const std::string grams = refusal(robot, {currents(robot, 1, 0.0)}, {currents(robot, 1, 2.5)}, 2500.0);
  EXPECT_NE(grams.find(words), std::string::npos) << grams;
  EXPECT_NE(refusal(robot, {currents(robot, 1, 2.5)}, {currents(robot, 1, 0.0)}, 2.5), "") << "swapped";
}

TEST(DriveGainsOfAChain, AMassInPoundsIsNoted) {
  mechanism::Robot robot = testArm();
  const std::vector<Observation> unloaded = {currents(robot, 1, 0.0)}, loaded = {currents(robot, 1, 2.5)};
  const DriveGains right = driveGains(robot, unloaded, loaded, 2.5, ObservationOptions());
  EXPECT_TRUE(right.notes.empty()) << right.notes.front();
  const DriveGains pounds = driveGains(robot, unloaded, loaded, 2.5 / 0.4536, ObservationOptions());
  ASSERT_EQ(pounds.notes.size(), 1u);
  EXPECT_NE(pounds.notes.front().find(" times what its URDF says"), std::string::npos) << pounds.notes.front();
}

}  // namespace
}  // namespace knee_robot::identification
