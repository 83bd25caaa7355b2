// Writes a report of every kind, with names that no friend would choose, into the folder KNEE_PAGES: browser_test.py
// opens them.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "knee_robot/report/drive_gains_report.h"
#include "knee_robot/report/predict_report.h"
#include "knee_robot/tuning/tuning_report.h"
#include "test/report/results.h"

namespace knee_robot::report {
namespace {

namespace fs = std::filesystem;

const std::string kName = "<img src=x onerror=\"window.pwned=1\">&amp; \xc3\xb1 " + std::string(120, 'w');
const std::string kLine = "</script><script>window.pwned=2</script><!-- " + kName + "\xff\xe2\x80\xa8";

/// KNEE_PAGES, else a folder that goes again.
class Pages : public ::testing::Test {
 protected:
  Pages() {
    const char* given = std::getenv("KNEE_PAGES");
    char pattern[] = "/tmp/knee_pages_XXXXXX";
    own_ = given == nullptr;
    folder_ = own_ ? mkdtemp(pattern) : given;
  }
  ~Pages() override {
    if (own_) fs::remove_all(folder_);
  }
  std::string in(const std::string& kind) const { return folder_ + "/" + kind; }
  void expectPage(const std::string& kind) const {
    EXPECT_EQ(embedded(readFile(in(kind) + "/report.html"))["report"],
              nlohmann::json::parse(readFile(in(kind) + "/report.json")));
  }
  std::string folder_;
  bool own_ = false;
};

void rename(std::vector<identification::Observation>& observations) {
  for (identification::Observation& o : observations) {
    o.name = "run";  // names a file
    o.path = kName;
    o.notes.push_back(kLine);
  }
}

TEST_F(Pages, OfIdentifyForAxesAndForAChain) {
  IdentifyResults r = identified(true);
  r.robot_path = kName;
  r.command_line = kLine;
  rename(r.train);
  rename(r.validate);
  writeIdentifyFiles(r, in("identify"));
  expectPage("identify");
  r.units = {{"Nm", "A"}, {1, 1}, {kName, "elbow"}};
  r.no_physical = kLine;
  writeIdentifyFiles(r, in("identify_chain"));
  expectPage("identify_chain");
}

TEST_F(Pages, OfTraceWithPoseGivenModelAndNextExperiment) {
  TraceResults r = traced();
  r.robot_path = kName;
  r.command_line = kLine;
  rename(r.train);
  rename(r.validate);
  r.result.notes.push_back(kLine);
  r.result.given.path = kName;
  r.result.given.effects.resize(1);
  r.result.given.effects[0].effect = r.model.effects.front();
  r.result.given.effects[0].verdict = kLine;
  r.next.first = kName;
  r.next.second = "stribeck on actuator 2";
  r.next.planned = true;
  r.next.reference.points = trajectory::Points::Constant(50, 4, 0.2);
  r.next.reference.points.col(1).setLinSpaced(0.2, 0.3);
  r.pose = poseOfAWrongRadius();
  writeTraceFiles(r, in("trace"));
  expectPage("trace");
}

TEST_F(Pages, OfCompareWithACamera) {
  const mechanism::Robot robot = robotB();
  recording::Recording run = recorded(robot, mechanism::Pose(0.001, 0, 0, 0));
  film(run, 0.02, 0.0, 0.0, 0.0, 0.0);
  run.name = kName;
  CompareResults c = compare(robot, run, 20.0);
  c.notes.push_back(kLine);
  c.command_line = kLine;
  writeCompareFiles(c, in("compare"));
  expectPage("compare");
}

TEST_F(Pages, OfPredict) {
  const IdentifyResults identified_ones = identified(true);
  PredictResults r;
  r.robot_path = r.model_path = kName;
  r.command_line = kLine;
  r.model = identified_ones.after.model;
  r.model.effects.resize(1);
  r.model.effects[0].name = kLine;
  r.observations = identified_ones.validate;
  rename(r.observations);
  r.applied = identified_ones.validate_after;
  writePredictFiles(r, in("predict"));
  expectPage("predict");
}

TEST_F(Pages, OfDriveGains) {
  const std::string urdf = fs::absolute(KNEE_SOURCE_DIR "/test/dynamics/chain.urdf").string();
  fs::create_directories(in("drive_gains"));
  const std::string path = in("drive_gains") + "/<img src=x onerror=\"window.pwned=3\">.yaml";
  std::ofstream(path) << "mechanism: chain\nurdf: " << urdf << "\nbase_link: base\ntip_link: tool\n";
  const mechanism::Robot robot = mechanism::loadAnyRobot(path);
  identification::DriveGains gains;
  gains.payload_kg = 2.8;
  gains.gain = Eigen::VectorXd::LinSpaced(robot.axes(), 10.0, 12.0);
  gains.std = gains.percent = Eigen::VectorXd::Constant(robot.axes(), 0.5);
  writeDriveGains(robot, gains, kLine, in("drive_gains"));
  expectPage("drive_gains");
}

TEST_F(Pages, OfTuning) {
  tuning::TuningResults r;
  r.recording = r.deployment = kName;
  const Eigen::Index rows = 4000;
  for (Eigen::Index k = 0; k < rows; ++k)
    r.responses.time_s.push_back(0.001 * static_cast<double>(k));
  r.responses.force_N = r.responses.model_N = Eigen::MatrixXd::Random(rows, 2);
  r.responses.axes.resize(2);
  r.responses.axes[0].mass_kg = 20.0;
  tuning::TunedAxis axis;
  axis.name = "leg 1";
  axis.driver = kName;
  axis.range.low = {15.0, 20.0, 0.001};
  axis.range.high = {30.0, 60.0, 0.002};
  axis.range_source = kLine;
  axis.highest_crossover_hz = 10.0;
  axis.proposed = tuning::proposeGains(axis.range, r.servo_period_s, r.demand, {});
  ASSERT_TRUE(axis.proposed);
  axis.present = *axis.proposed;
  axis.present.proportional *= 0.5;
  axis.proposed_worst = tuning::worstMargins(*axis.proposed, axis.range, r.servo_period_s);
  axis.present_worst = tuning::worstMargins(axis.present, axis.range, r.servo_period_s);
  tuning::TunedAxis not_judged;
  not_judged.name = "leg 2";
  not_judged.reason = kLine;
  r.axes = {axis, not_judged};
  tuning::writeTuning(r, kLine, in("tune_pid"));
  expectPage("tune_pid");
  EXPECT_EQ(nlohmann::json::parse(readFile(in("tune_pid") + "/report.json"))["axes"][0]["measured"]["mass_kg"], 20.0);
}

}  // namespace
}  // namespace knee_robot::report
