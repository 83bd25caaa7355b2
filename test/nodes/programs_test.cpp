// The offline programs one after the other, as a user calls them: a movement is planned, checked, played on the
// simulated robot, compared, identified from, traced and predicted.
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "knee_robot/base/files.h"
#include "knee_robot/mechanism/robot.h"
#include "test/control/some_model.h"

namespace {

namespace fs = std::filesystem;

const std::string kConfig = std::string(KNEE_SOURCE_DIR) + "/config";
const std::string kRobot = " --robot " + kConfig + "/robots/A.yaml ";

struct Ended {
  int status;
  std::string output;  ///< both streams
};

class Programs : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    char pattern[] = "/tmp/knee_programs_XXXXXX";
    folder() = ::mkdtemp(pattern);
  }
  static void TearDownTestSuite() { fs::remove_all(folder()); }

  static std::string& folder() {
    static std::string path;
    return path;
  }
  static std::string in(const std::string& name) { return folder() + "/" + name; }

  static Ended run(const std::string& command) {
    const int status = std::system((command + " > " + in("output") + " 2>&1").c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, knee_robot::readFile(in("output"))};
  }

  /// An excitation and its recording on the simulated robot, made when first asked for.
  static std::string recording(int seed) {
    const std::string reference = in("excitation_" + std::to_string(seed) + ".txt");
    const std::string recorded = in("run_" + std::to_string(seed) + ".csv");
    if (fs::exists(recorded)) return recorded;
    const Ended planned = run(KNEE_PLAN_EXCITATION + kRobot + "--seed " + std::to_string(seed) +
                              " --duration 12 --seconds-budget 3 -o " + reference);
    EXPECT_EQ(0, planned.status) << planned.output;
    const Ended played = simulate(reference, recorded);
    EXPECT_EQ(0, played.status) << played.output;
    return recorded;
  }

  static Ended simulate(const std::string& reference, const std::string& recorded, const std::string& more = "") {
    return run(KNEE_SIMULATE + kRobot + "--simulation " + kConfig + "/simulation/A.yaml --hardware " + kConfig +
               "/hardware/simulated.yaml --deployment " + kConfig + "/deployment/simulation.yaml " + reference +
               " -o " + recorded + " " + more);
  }

  /// Times of the rows of a recording, s.
  static std::vector<double> times(const std::string& path) {
    std::ifstream stream(path);
    std::vector<double> out;
    for (std::string line; std::getline(stream, line);)
      if (!line.empty() && std::isdigit(static_cast<unsigned char>(line[0])) != 0) out.push_back(std::stod(line));
    return out;
  }

  static nlohmann::json report(const std::string& name) {
    return nlohmann::json::parse(knee_robot::readFile(in(name + "/report.json")));
  }

  static std::size_t linesOf(const std::string& path) {
    std::ifstream stream(path);
    std::size_t lines = 0;
    for (std::string line; std::getline(stream, line);)
      ++lines;
    return lines;
  }
};

TEST_F(Programs, PlanExerciseWritesAMovementThatCheckReferenceAccepts) {
  const Ended planned = run(KNEE_PLAN_EXERCISE + kRobot + "hip_flexion -o " + in("hip.txt"));
  ASSERT_EQ(0, planned.status) << planned.output;
  EXPECT_TRUE(fs::exists(in("hip.svg")));
  const Ended checked = run(KNEE_CHECK_REFERENCE + kRobot + in("hip.txt"));
  EXPECT_EQ(0, checked.status) << checked.output;

  std::ofstream(in("jump.txt")) << "0.7 0.7 0.7 0.7\n0.8 0.7 0.7 0.7\n";
  const Ended refused = run(KNEE_CHECK_REFERENCE + kRobot + in("jump.txt"));
  EXPECT_EQ(2, refused.status);
  EXPECT_NE(std::string::npos, refused.output.find("jump.txt:2: ")) << refused.output;
}

TEST_F(Programs, SimulateRecordsARowPerCycleAndDoesNotOverwrite) {
  const std::string recorded = recording(1);
  EXPECT_GT(linesOf(recorded), 12000u);
  const Ended again = simulate(in("excitation_1.txt"), recorded);
  EXPECT_EQ(2, again.status);
  EXPECT_NE(std::string::npos, again.output.find("run_1.csv")) << again.output;
}

TEST_F(Programs, SimulateLeavesOutTheRowsOfPausesOfTheMachine) {
  recording(1);
  const Ended played =
      simulate(in("excitation_1.txt"), in("paused.csv"), "--pauses-per-minute 300 --longest-pause-s 0.01");
  ASSERT_EQ(0, played.status) << played.output;
  const std::vector<double> rows = times(in("paused.csv"));
  ASSERT_GT(rows.size(), 11000u);
  int gaps = 0;
  for (std::size_t n = 1; n < rows.size(); ++n) {
    EXPECT_LT(rows[n] - rows[n - 1], 0.0125);
    if (rows[n] - rows[n - 1] > 0.0025) ++gaps;
  }
  EXPECT_GT(gaps, 20) << "about 50 pauses, most of which are longer than a cycle";
  EXPECT_NE(std::string::npos, played.output.find("pauses of the machine: ")) << played.output;
}

TEST_F(Programs, SimulateSaysOfAFaultThatTheMachineStoodStillBefore) {
  recording(1);
  const Ended stopped =
      simulate(in("excitation_1.txt"), in("stopped.csv"), "--pauses-per-minute 120 --longest-pause-s 0.6");
  EXPECT_EQ(3, stopped.status) << stopped.output;
  EXPECT_NE(std::string::npos, stopped.output.find("(the controller had stood still for ")) << stopped.output;
}

TEST_F(Programs, SimulateNamesAnImpossibleModelAsACauseOfTheFault) {
  recording(1);
  knee_robot::dynamics::Model model =
      knee_robot::fake::modelOf(knee_robot::mechanism::loadRobot(kConfig + "/robots/A.yaml"));
  const auto withPlatformOf = [&](double mass_kg) {
    for (knee_robot::dynamics::ModelParameter& parameter : model.parameters) {
      if (parameter.name == "m_M") parameter.value = mass_kg;
    }
    knee_robot::dynamics::saveModel(model, in("negative.yaml"));
    return simulate(in("excitation_1.txt"), in("pushed.csv"), "--model " + in("negative.yaml"));
  };
  const Ended refused = withPlatformOf(-400.0);
  EXPECT_EQ(2, refused.status) << refused.output;
  EXPECT_NE(std::string::npos, refused.output.find("negative.yaml: asks axis 1 for -")) << refused.output;
  const Ended stopped = withPlatformOf(-60.0);
  EXPECT_NE(0, stopped.status) << stopped.output;
  EXPECT_NE(std::string::npos, stopped.output.find("or the feedforward pushes it: the model " + in("negative.yaml")))
      << stopped.output;
}

TEST_F(Programs, CompareShowsReferenceAgainstMeasured) {
  const Ended compared = run(KNEE_COMPARE + kRobot + recording(1) + " --output " + in("compared"));
  ASSERT_EQ(0, compared.status) << compared.output;
  const nlohmann::json figures = report("compared");
  ASSERT_EQ(4u, figures["actuators"].size());
  EXPECT_LT(figures["actuators"][0]["rms_m"].get<double>(), 1e-3);
  for (const char* name : {"report.html", "actuators.svg", "pose.svg"})
    EXPECT_TRUE(fs::exists(in("compared/") + name)) << name;
}

TEST_F(Programs, SimulatedCameraAddsWhatItSawAndCompareFindsItsDelayAndItsPlace) {
  std::ofstream(in("camera.yaml")) << "delay_s: 0.05\nrotation_rad: 0.05\nshift_x_m: 0.8\n";
  const std::string command = KNEE_SIMULATED_CAMERA + kRobot + "--camera " + in("camera.yaml") + " ";
  EXPECT_EQ(2, run(command + recording(1) + " -o " + recording(1)).status) << "it would overwrite what it reads";
  const Ended looked = run(command + recording(1) + " -o " + in("seen.csv"));
  ASSERT_EQ(0, looked.status) << looked.output;
  EXPECT_EQ(linesOf(recording(1)), linesOf(in("seen.csv")));
  const Ended compared = run(KNEE_COMPARE + kRobot + in("seen.csv") + " --output " + in("seen"));
  ASSERT_EQ(0, compared.status) << compared.output;
  const nlohmann::json camera = report("seen")["camera"];
  EXPECT_NEAR(-0.05, camera["alignment"]["rotation_rad"].get<double>(), 2e-3);
  EXPECT_NEAR(0.05, camera["alignment"]["delay_s"].get<double>(), 5e-3);
  EXPECT_GT(camera["camera_minus_encoders"]["x"]["rows"].get<int>(), 1000);

  const Ended shipped = run(KNEE_SIMULATED_CAMERA + kRobot + "--camera " + kConfig + "/simulation/camera.yaml " +
                            recording(1) + " -o " + in("shipped.csv"));
  EXPECT_EQ(0, shipped.status) << shipped.output;
  const Ended twice = run(command + in("seen.csv") + " -o " + in("twice.csv"));
  EXPECT_EQ(2, twice.status);
  EXPECT_NE(std::string::npos, twice.output.find("has camera columns already")) << twice.output;
  EXPECT_FALSE(fs::exists(in("twice.csv")));
  std::ofstream(in("blurred.yaml")) << "noise_m: blurred\n";
  const Ended refused = run(KNEE_SIMULATED_CAMERA + kRobot + "--camera " + in("blurred.yaml") + " " + recording(1) +
                            " -o " + in("no.csv"));
  EXPECT_EQ(2, refused.status);
  EXPECT_NE(std::string::npos, refused.output.find("blurred.yaml:1: noise_m")) << refused.output;
}

TEST_F(Programs, TraceReportsBeforeAndAfterAndPredictAppliesItsModel) {
  const Ended traced = run(KNEE_TRACE + kRobot + "--train " + recording(1) + " --validate " + recording(2) +
                           " --output " + in("traced"));
  ASSERT_EQ(0, traced.status) << traced.output;
  const nlohmann::json figures = report("traced");
  EXPECT_EQ("trace", figures["command"]);
  ASSERT_EQ(4u, figures["after"]["validate"]["rms_N"].size());
  EXPECT_LT(figures["after"]["validate"]["rms_percent"][0].get<double>(), 20.0);

  const Ended predicted = run(KNEE_PREDICT + kRobot + "--model " + in("traced/model.yaml") + " " + recording(2) +
                              " --output " + in("predicted"));
  ASSERT_EQ(0, predicted.status) << predicted.output;
  EXPECT_EQ(linesOf(recording(2)), linesOf(in("predicted/prediction_run_2.csv"))) << "one row per row";
  EXPECT_EQ(linesOf(recording(2)), linesOf(in("traced/prediction_run_2.csv")));
}

TEST_F(Programs, PredictRefusesTheModelOfAnotherRobot) {
  const Ended traced = run(KNEE_TRACE + kRobot + "--most 0 --train " + recording(1) + " --output " + in("baseline"));
  ASSERT_EQ(0, traced.status) << traced.output;
  const Ended refused = run(KNEE_PREDICT + std::string(" --robot ") + kConfig + "/robots/B.yaml --model " +
                            in("baseline/model.yaml") + " " + recording(2) + " --output " + in("wrong"));
  EXPECT_EQ(2, refused.status) << refused.output;
  EXPECT_FALSE(fs::exists(in("wrong/prediction_run_2.csv")));
}

TEST_F(Programs, ImportRecordingTurnsAnotherRecordersTableIntoARecording) {
  std::ofstream table(in("foreign.tsv"));
  table << "ms\tlength\tvolts\n";
  for (int k = 0; k < 50; ++k)
    table << 10 * k << '\t' << 600 + k << '\t' << 0.1 * k << '\n';
  table.close();
  const std::string columns =
      " --column 'ms=time_s,ms' --column 'length=position_1_m,mm' --column 'volts=command_1_V' ";
  const Ended imported =
      run(KNEE_IMPORT_RECORDING + std::string(" ") + in("foreign.tsv") + columns + "-o " + in("own.csv"));
  ASSERT_EQ(0, imported.status) << imported.output;
  const std::string text = knee_robot::readFile(in("own.csv"));
  EXPECT_NE(std::string::npos, text.find("position_1_m")) << text.substr(0, 200);
  EXPECT_NE(std::string::npos, text.find("0.649")) << "the last row's 649 mm";

  const Ended refused = run(KNEE_IMPORT_RECORDING + std::string(" ") + in("foreign.tsv") +
                            " --column 'ms=time_s,kg' -o " + in("wrong.csv"));
  EXPECT_EQ(2, refused.status);
  EXPECT_FALSE(fs::exists(in("wrong.csv")));
}

TEST_F(Programs, VirtualPlantRecordsTheForcesOfAnotherEngine) {
  recording(1);
  const Ended moved =
      run(KNEE_VIRTUAL_PLANT + kRobot + in("excitation_1.txt") + " --seed 3 --noise 0.1 -o " + in("plant.csv"));
  ASSERT_EQ(0, moved.status) << moved.output;
  EXPECT_GT(linesOf(in("plant.csv")), 1000u);
}

}  // namespace
