// Recordings of physical robots, where they are at hand (see KNEE_SHARED_DIR); they are not part of this repository.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "knee_robot/identification/evaluation.h"
#include "knee_robot/identification/physical_fit.h"

namespace knee_robot::identification {
namespace {

std::string measured(const std::string& name) {
  const char* const shared = std::getenv("KNEE_SHARED_DIR");
  const std::string root = shared != nullptr ? shared : std::string(KNEE_SOURCE_DIR) + "/../shared";
  return root + "/data/measured/" + name + ".csv";
}

mechanism::Robot robotFile(const std::string& name) {
  return mechanism::loadRobot(std::string(KNEE_SOURCE_DIR) + "/config/robots/" + name);
}

std::vector<Observation> observeFile(const mechanism::Robot& robot, const std::string& path) {
  std::vector<Observation> list;
  list.push_back(observe(robot, columnsOf(robot), recording::loadRecording(path), ObservationOptions()));
  return list;
}

Accuracy validated(const std::string& robot_name, const std::string& train, const std::string& validate) {
  const mechanism::Robot robot = robotFile(robot_name);
  std::vector<Observation> training = observeFile(robot, train);
  const Identification id = identify(robot, training, IdentifyOptions());
  const Accuracy a = applyModel(id.model, robot, observeFile(robot, validate), 3.0).accuracy;
  std::cout << "rank " << id.model.rank << ", moving " << a.rms_moving_N.transpose() << " N, all "
            << a.rms_N.transpose() << " N\n";
  return a;
}

/// An independent least-squares analysis reached 5.9 / 5.6 / 4.1 / 34 N; 20 % more is the limit.
TEST(MeasuredRobotB, OtherPathIsPredictedWithinAFifthOfTheIndependentAnalysis) {
  const std::string path_1 = measured("B_N_20_01_2021_161533"), path_2 = measured("B_N_01_02_2021_122900");
  if (!std::filesystem::exists(path_1)) GTEST_SKIP() << path_1 << " is not here";
  const Accuracy a = validated("B.yaml", path_1, path_2);
  const mechanism::Vector4 independent(5.9, 5.6, 4.1, 34.0);
  for (int i = 0; i < 4; ++i)
    EXPECT_LT(a.rms_moving_N[i], 1.2 * independent[i]) << "actuator " << i + 1;
  EXPECT_LT(a.rms_percent.maxCoeff(), 30.0)
      << "all samples: with sign(v) instead of a friction memory actuator 4 is wrong by 86 %";
}

TEST(MeasuredRobotB, ThePathsCanChangeRoles) {
  const std::string path_1 = measured("B_N_20_01_2021_161533"), path_2 = measured("B_N_01_02_2021_122900");
  if (!std::filesystem::exists(path_1)) GTEST_SKIP() << path_1 << " is not here";
  const Accuracy a = validated("B.yaml", path_2, path_1);
  const mechanism::Vector4 independent(5.9, 5.6, 4.1, 34.0);
  for (int i = 0; i < 4; ++i)
    EXPECT_LT(a.rms_moving_N[i], 1.2 * independent[i]) << "actuator " << i + 1;
}

TEST(MeasuredRobotB, PossibleBodiesPredictTheOtherPathNoWorseThanTheBaseFit) {
  const std::string path_1 = measured("B_N_20_01_2021_161533"), path_2 = measured("B_N_01_02_2021_122900");
  if (!std::filesystem::exists(path_1)) GTEST_SKIP() << path_1 << " is not here";
  const mechanism::Robot robot = robotFile("B.yaml");
  for (const bool forward : {true, false}) {
    std::vector<Observation> training = observeFile(robot, forward ? path_1 : path_2);
    const std::vector<Observation> validation = observeFile(robot, forward ? path_2 : path_1);
    const Identification id = identify(robot, training, IdentifyOptions());
    const PhysicalFit fit = fitPhysical(robot, id, dynamics::loadRobotInertia(robot));
    const Accuracy base = applyModel(id.model, robot, validation, 3.0).accuracy;
    const Accuracy physical = applyModel(fit.model, robot, validation, 3.0).accuracy;
    std::cout << "moving: base " << base.rms_moving_N.transpose() << " N, possible bodies "
              << physical.rms_moving_N.transpose() << " N\n";
    for (const dynamics::LinkInertia& body : fit.inertia.links)
      EXPECT_EQ(dynamics::inconsistency(body), "");
    EXPECT_LT(physical.rms_moving_N.cwiseQuotient(base.rms_moving_N).mean(), 1.05);
  }
}

/// 54 s in seven blocks say little about the links. Laws near rest that were chosen while hardly anything held these leave
/// 13.2 N on leg 2 of the other day (31 N at the cut-off that identify chooses).
TEST(MeasuredRobotA, LawsBesideLinksThatOneRecordingHardlyDecidesHoldOnAnotherDay) {
  const std::string train = measured("A_V_22_03_2021_155607"), validate = measured("A_N_18_12_2020_123629");
  if (!std::filesystem::exists(train)) GTEST_SKIP() << train << " is not here";
  const Accuracy a = validated("A.yaml", train, validate);
  EXPECT_LT(a.rms_N[1], 11.5);
}

/// The cameras saw this robot in its other assembly mode from 25.27 to 27.91 s.
TEST(MeasuredRobotA, WhereCamerasSawTheOtherAssemblyModeIsMasked) {
  const std::string path = measured("A_V_22_03_2021_155607");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const Observation o = observeFile(robotFile("A.yaml"), path).front();
  int masked = 0;
  for (int n = 0; n < o.samples(); ++n) {
    const std::size_t i = static_cast<std::size_t>(n);
    masked += !o.usable[i];
    const bool seen = o.signals.time_s[i] > 25.2 && o.signals.time_s[i] < 28.0;
    EXPECT_FALSE(seen && o.usable[i]) << o.signals.time_s[i];
  }
  EXPECT_LT(masked, o.samples() / 2) << "most of the recording is told by its encoders";
}

TEST(MeasuredBench, ItsFrictionExplainsMostOfTheForce) {
  const std::string path = measured("BENCH_V_17_12_2020_125008");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const mechanism::Robot robot = robotFile("bench.yaml");
  std::vector<Observation> training = observeFile(robot, path);
  const Identification id = identify(robot, training, IdentifyOptions());
  EXPECT_EQ(id.model.rank, 16);
  const Accuracy a = applyModel(id.model, robot, training, 3.0).accuracy;
  EXPECT_LT(a.rms_percent.maxCoeff(), 20.0);
}

}  // namespace
}  // namespace knee_robot::identification
