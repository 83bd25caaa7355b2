// identify and trace as a user calls them, without any option: the baseline of trace is the model of identify.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "test/nodes/bench_robot.h"

namespace {

namespace fs = std::filesystem;
using knee_robot::TemporaryFolder, knee_robot::writeBenchRobot;

struct Bench {
  double pause_s = 0.0;         ///< without rows, after 12 s
  double near_rest_m_s = 1e-3;  ///< dry friction is full well beyond this
  double drag = 3000.0;         ///< N s2/m2
};

/// Two axes with friction and a drag that no baseline has.
fs::path writeRecording(const TemporaryFolder& folder, const std::string& name, double turns, const Bench& bench = {}) {
  const fs::path file = folder / name;
  std::ofstream stream(file);
  stream << "time_s,reference_1_m,position_1_m,force_1_N,reference_2_m,position_2_m,force_2_N\n";
  stream.precision(12);
  const auto position = [&](double t, double w) { return 0.2 + 0.05 * std::sin(w * t) + 0.02 * std::sin(2.3 * w * t); };
  for (int k = 0; k < 2400; ++k) {
    const double t = 0.01 * k;
    stream << t + (t > 12.0 ? bench.pause_s : 0.0);
    for (const double w : {turns, 1.3 * turns}) {
      const double q = position(t, w), v = (position(t + 0.0051, w) - position(t + 0.0049, w)) / 2e-4;
      const double a = (position(t + 0.006, w) - 2.0 * position(t + 0.005, w) + position(t + 0.004, w)) / 1e-6;
      const double force =
          8.0 * a + 200.0 * v + 15.0 * std::tanh(v / bench.near_rest_m_s) + bench.drag * v * std::abs(v) + 2.0;
      stream << ',' << q << ',' << q << ',' << force;
    }
    stream << '\n';
  }
  return file;
}

nlohmann::json reportOf(const TemporaryFolder& folder, const std::string& program, const fs::path& training,
                        const Bench& bench = {}) {
  const fs::path out = folder / fs::path(program.substr(0, program.find(' '))).filename();
  const std::string command = program + " --robot " + writeBenchRobot(folder).string() + " --train " +
                              training.string() + " --validate " +
                              writeRecording(folder, "other.csv", 1.7, bench).string() + " --output " + out.string() +
                              " > " + (folder / "log.txt").string() + " 2>&1";
  if (WEXITSTATUS(std::system(command.c_str())) != 0) {
    ADD_FAILURE() << std::ifstream(folder / "log.txt").rdbuf();
    return {};
  }
  return nlohmann::json::parse(std::ifstream(out / "report.json"));
}

TEST(BaselineOfPrograms, TraceStartsWhereIdentifyEnds) {
  const TemporaryFolder folder;
  const fs::path training = writeRecording(folder, "training.csv", 1.2);
  const nlohmann::json identified = reportOf(folder, KNEE_IDENTIFY, training);
  const nlohmann::json traced = reportOf(folder, std::string(KNEE_TRACE) + " --most 0", training);
  for (const char* side : {"train", "validate"}) {
    for (const char* figure : {"rms_N", "rms_moving_N", "rms_raw_N"}) {
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const double after = identified["after"][side][figure][axis], before = traced["before"][side][figure][axis];
        EXPECT_GT(after, 0.01) << "the drag is left";
        EXPECT_NEAR(before, after, 1e-4 * after) << side << " " << figure << " of axis " << axis + 1;
      }
    }
  }
}

TEST(BaselineOfPrograms, TheErrorsAgainstThePriorsStrengthGoThroughThoseOfTheModel) {
  const TemporaryFolder folder;
  const Bench slow{0.0, 0.02, 300.0};  // nothing like the law that the fit begins with
  const nlohmann::json report =
      reportOf(folder, KNEE_IDENTIFY, writeRecording(folder, "training.csv", 1.2, slow), slow);
  for (const nlohmann::json& point : report["rank"]["curve"]) {
    if (point["rank"] != report["rank"]["chosen"]) continue;
    for (const std::string side : {"train", "validate"}) {
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const double there = point[side + "_moving_N"][axis], after = report["after"][side]["rms_moving_N"][axis];
        EXPECT_NEAR(there, after, 0.25 * after)  // rows and fit take the motion from positions low-passed differently
            << side << ", axis " << axis + 1;
      }
    }
    return;
  }
  FAIL() << "the chosen rank is not on the curve";
}

TEST(BaselineOfPrograms, TraceLeavesALongPauseOut) {
  const TemporaryFolder folder;
  const nlohmann::json traced =
      reportOf(folder, std::string(KNEE_TRACE) + " --most 0", writeRecording(folder, "training.csv", 1.2, {3600.0}));
  ASSERT_FALSE(traced.is_null());
  EXPECT_LT(traced["after"]["train"]["samples"], 2400 + 250) << "an hour at 100 Hz would be 360 000";
}

}  // namespace
