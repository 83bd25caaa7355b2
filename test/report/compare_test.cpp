#include "knee_robot/report/compare.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "test/refusal.h"
#include "test/report/results.h"
#include "test/temporary_folder.h"

namespace knee_robot::report {
namespace {

namespace fs = std::filesystem;

/// The page of a comparison.
std::string pageOf(const CompareResults& c) {
  const TemporaryFolder folder;
  writeCompareFiles(c, folder);
  const std::string html = readFile(folder + "/report.html");
  return html;
}

TEST(Compare, GivesLargestRmsAndMeanErrorPerActuator) {
  const mechanism::Robot robot = robotB();
  recording::Recording r = recorded(robot);
  r.position_m.col(1).array() += 0.001;
  r.position_m(700, 1) += 0.004;
  const CompareResults c = compare(robot, r, 60.0);
  EXPECT_EQ(c.actuators[0].max_abs, 0.0);
  EXPECT_NEAR(c.actuators[1].max_abs, 0.005, 1e-12);
  EXPECT_NEAR(c.actuators[1].time_of_max_s, 7.0, 1e-12);
  EXPECT_NEAR(c.actuators[1].mean, 0.001 + 0.004 / 2000, 1e-12);
  EXPECT_NEAR(c.actuators[1].rms, std::sqrt((1999 * 1e-6 + 25e-6) / 2000), 1e-12);
}

TEST(Compare, FindsThePoseErrorBehindTheLengths) {
  const mechanism::Robot robot = robotB();
  const mechanism::Pose error(0.003, -0.001, 0.5 * kDegree, -1.0 * kDegree);
  const CompareResults c = compare(robot, recorded(robot, error), 60.0);
  ASSERT_TRUE(c.has_pose);
  EXPECT_EQ(c.measured.unknown + c.reference.unknown, 0);
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(c.pose[k].mean, error[k], 1e-9);
    EXPECT_NEAR(c.pose[k].max_abs, std::abs(error[k]), 1e-9);
  }
  EXPECT_FALSE(c.has_camera);
}

TEST(Compare, RecoversTheCamerasDelayAndFrame) {
  const mechanism::Robot robot = robotB();
  recording::Recording r = recorded(robot);
  film(r, 0.0374, 3.0 * kDegree, 0.2, -0.05, -4.0 * kDegree);
  for (int i = 0; i < 150; ++i)
    r.mocap.row(i).setConstant(kNan);
  for (int i = 1000; i < 1100; ++i)
    r.mocap.row(i).setConstant(kNan);
  const CompareResults c = compare(robot, r, 60.0);
  ASSERT_TRUE(c.has_camera);
  const tracing::CameraAlignment& a = c.camera.alignment;
  ASSERT_TRUE(a.delay_known);
  EXPECT_NEAR(a.delay_s, 0.0374, 5e-4);
  EXPECT_NEAR(a.rotation_rad, 3.0 * kDegree, 1e-4);
  EXPECT_NEAR(a.shift_x_m, 0.2, 1e-4);
  EXPECT_NEAR(a.shift_z_m, -0.05, 1e-4);
  EXPECT_NEAR(a.plate_rad, -4.0 * kDegree, 1e-4);
  EXPECT_EQ(c.camera.other_solution, 0);
  for (int k = 0; k < 4; ++k)
    EXPECT_LT(c.camera.error[k].rms, 5e-5) << k;
}

TEST(Compare, AlignsACameraThatIsEarlyAsWell) {
  const mechanism::Robot robot = robotB();
  recording::Recording r = recorded(robot, mechanism::Pose::Zero(), 0.005);
  film(r, -0.12, 0.0, 0.0, 0.0, 0.0);
  EXPECT_NEAR(compare(robot, r, 60.0).camera.alignment.delay_s, -0.12, 5e-4);
}

TEST(Compare, SwappedMarkersInATenthOfThePicturesDoNotMoveTheFrame) {
  const mechanism::Robot robot = robotB();
  recording::Recording r = recorded(robot);
  film(r, 0.0, 1.0 * kDegree, 0.01, 0.02, 0.0);
  std::mt19937 random(3);
  for (int i = 0; i < r.rows(); ++i) {
    if (random() % 10 == 0) r.mocap.row(i) += Eigen::RowVector4d(0.2, -0.1, 0.5, 1.0);
  }
  const tracing::CameraAlignment a = compare(robot, r, 60.0).camera.alignment;
  EXPECT_NEAR(a.rotation_rad, 1.0 * kDegree, 1e-5);
  EXPECT_NEAR(a.shift_x_m, 0.01, 1e-5);
  EXPECT_NEAR(a.shift_z_m, 0.02, 1e-5);
}

TEST(Compare, DoesNotInventADelayWithoutMotion) {
  const mechanism::Robot robot = robotB();
  recording::Recording r = recorded(robot);
  r.position_m.rowwise() = r.position_m.row(0).eval();
  film(r, 0.0, 0.0, 0.0, 0.0, 0.0);
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 1e-4);
  for (int i = 0; i < r.rows(); ++i) {
    for (int k = 0; k < 4; ++k)
      r.mocap(i, k) = poseAt(0.0)[k] + noise(random);
  }
  const CompareResults c = compare(robot, r, 60.0);
  EXPECT_FALSE(c.camera.alignment.delay_known);
  EXPECT_EQ(c.camera.alignment.delay_s, 0.0);
  EXPECT_NE(c.notes.back().find("could not be determined"), std::string::npos);
}

TEST(Compare, ACameraWithoutPicturesIsSaidToBeUseless) {
  const mechanism::Robot robot = robotB();
  recording::Recording r = recorded(robot);
  r.mocap = Eigen::MatrixXd::Constant(r.rows(), 4, kNan);
  const CompareResults c = compare(robot, r, 60.0);
  EXPECT_FALSE(c.has_camera);
  EXPECT_NE(c.notes.back().find("too few poses"), std::string::npos);
}

TEST(Compare, RefusesWhatCannotBeCompared) {
  const mechanism::Robot robot = robotB();
  recording::Recording r = recorded(robot);
  r.reference_m.resize(r.rows(), 0);
  EXPECT_NE(refusalOf([&] { compare(robot, r, 60.0); }).find("reference_1_m is missing"), std::string::npos);
  recording::Recording foreign = recorded(robot);
  foreign.position_m.array() *= 0.01;
  EXPECT_THROW(compare(robot, foreign, 60.0), Refusal);
  recording::Recording two = recorded(robot);
  two.axes = 2;
  EXPECT_NE(refusalOf([&] { compare(robot, two, 60.0); }).find("records 2 actuators"), std::string::npos);
}

TEST(Compare, ARecordingWithoutReferenceStillHasItsCamera) {
  const mechanism::Robot robot = robotB();
  recording::Recording r = recorded(robot);
  r.mocap.resize(r.rows(), 4);
  for (int i = 0; i < r.rows(); ++i)
    r.mocap.row(i) = poseAt(r.time_s[static_cast<std::size_t>(i)]).transpose();
  r.reference_m.resize(r.rows(), 0);
  const CompareResults c = compare(robot, r, 60.0);
  ASSERT_TRUE(c.has_camera);
  EXPECT_GT(c.camera.error[0].rows, 100);
  EXPECT_EQ(c.actuators[0].rows, 0);
  EXPECT_TRUE(nlohmann::json::parse(compareJson(c))["actuators"][0]["rms_m"].is_null());
  EXPECT_EQ(compareSummary(c).find("nan"), std::string::npos) << compareSummary(c);
  const nlohmann::json series = embedded(pageOf(c))["series"];
  EXPECT_TRUE(series["reference_m"][0][0].is_null());
  EXPECT_TRUE(series["pose"]["camera"][0][700].is_number());
}

TEST(Compare, WritesBothFiguresAsPictures) {
  const TemporaryFolder folder;
  writeCompareFiles(compare(robotB(), recorded(robotB()), 60.0), folder);
  for (const char* name : {"/actuators.svg", "/pose.svg"}) {
    const std::string svg = readFile(folder + name);
    EXPECT_EQ(svg.find("<svg xmlns"), 0u);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    std::size_t panels = 0;
    for (std::size_t at = svg.find("<svg x="); at != std::string::npos; at = svg.find("<svg x=", at + 1))
      ++panels;
    EXPECT_EQ(panels, 8u) << name;  // value and error of each
  }
}

TEST(Compare, IndependentAxesHaveNoPose) {
  mechanism::Robot bench = robotB();
  bench.kind = mechanism::MechanismKind::Axes;
  bench.mechanism.reset();
  CompareResults c = compare(bench, recorded(robotB()), 60.0);
  EXPECT_FALSE(c.has_pose);
  EXPECT_TRUE(embedded(pageOf(c))["series"]["pose"].is_null());
  EXPECT_TRUE(nlohmann::json::parse(compareJson(c))["pose"].is_null());
}

TEST(CompareFiles, AreSelfContainedEscapedAndParsable) {
  const mechanism::Robot robot = robotB();
  recording::Recording r = recorded(robot, mechanism::Pose(0.001, 0, 0, 0));
  film(r, 0.02, 0.0, 0.0, 0.0, 0.0);
  CompareResults c = compare(robot, r, 60.0);
  c.command_line = "compare \"<x>\"";
  const TemporaryFolder folder;
  writeCompareFiles(c, folder + "/deep/er");
  const std::string html = readFile(folder + "/deep/er/report.html");
  const nlohmann::json j = nlohmann::json::parse(readFile(folder + "/deep/er/report.json"));
  for (const char* outside : {"http:", "https:", "src=", "<link", "run <1>", "\"<x>\""})
    EXPECT_EQ(ownPart(html).find(outside), std::string::npos) << outside;
  EXPECT_EQ(embedded(html)["report"], j);
  const nlohmann::json series = embedded(html)["series"];
  for (const char* line : {"reference_m", "measured_m", "error_m"})
    EXPECT_EQ(series[line].size(), 4u) << line;
  for (const char* line : {"reference", "encoders", "error", "camera", "camera_error"})
    ASSERT_EQ(series["pose"][line].size(), 4u) << line;
  EXPECT_EQ(series["pose"]["camera_error"][3].size(), series["time_s"].size());
  EXPECT_EQ(j["command"], "compare");
  EXPECT_EQ(j["actuators"].size(), 4u);
  EXPECT_NEAR(j["pose"]["x"]["max_m"].get<double>(), 0.001, 1e-9);
  EXPECT_NEAR(j["camera"]["alignment"]["delay_s"].get<double>(), 0.02, 1e-3);
  EXPECT_EQ(j["paper"].size(), 8u);
  EXPECT_EQ(j["paper"][3]["largest_error"], "above 2");
}

/// Laboratory recordings with cameras.
class MeasuredTest : public ::testing::TestWithParam<const char*> {
 protected:
  CompareResults compareMeasured(const std::string& name) {
    const mechanism::Robot robot =
        mechanism::loadRobot(KNEE_SOURCE_DIR "/config/robots/" + name.substr(0, 1) + ".yaml");
    return compare(robot, recording::loadRecording(folder() + name + ".csv"), 60.0);
  }
  static std::string folder() {
    const char* shared = std::getenv("KNEE_SHARED_DIR");
    return (shared ? std::string(shared) + "/data" : KNEE_SOURCE_DIR "/../shared/data") + "/measured/";
  }
};

TEST_P(MeasuredTest, TheCamerasAgreeWithForwardKinematicsToMillimetresAwayFromSingularities) {
  const std::string name = GetParam();
  if (!fs::exists(folder() + name + ".csv")) GTEST_SKIP() << folder() + name << ".csv is absent";
  const CompareResults c = compareMeasured(name);
  ASSERT_TRUE(c.has_camera);
  EXPECT_TRUE(c.camera.alignment.delay_known) << c.camera.alignment.correlation;
  const ErrorFigures* e = c.camera.error_regular;
  EXPECT_GT(e[0].rows, 4000);
  EXPECT_LT(e[0].rms, 0.003);
  EXPECT_LT(e[1].rms, 0.0015);
  EXPECT_LT(e[2].rms, 0.3 * kDegree);
  EXPECT_LT(e[3].rms, 0.6 * kDegree);
  std::cout << compareSummary(c);
}

INSTANTIATE_TEST_SUITE_P(Recordings, MeasuredTest,
                         ::testing::Values("B_N_01_02_2021_122900", "A_V_03_03_2021_132946", "A_V_22_03_2021_155607"));

TEST_F(MeasuredTest, WhereTheCamerasLeaveForwardKinematicsTheLengthsHaveASecondPoseNearby) {
  const std::string name = "A_V_22_03_2021_155607";
  if (!fs::exists(folder() + name + ".csv")) GTEST_SKIP() << folder() + name << ".csv is absent";
  const CameraComparison camera = compareMeasured(name).camera;
  EXPECT_GT(camera.other_solution, 50);
  EXPECT_GT(camera.error[0].max_abs, 0.05);
  EXPECT_LT(camera.error_nearest[0].rms, 0.5 * camera.error[0].rms);
  EXPECT_LT(camera.error_nearest[3].rms, 0.5 * camera.error[3].rms);
}

}  // namespace
}  // namespace knee_robot::report
