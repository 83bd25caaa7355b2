// plan_excitation and drive_gains of a chain as a user calls them: what they refuse, in one sentence, with nothing
// written.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "knee_robot/base/files.h"
#include "test/temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using namespace knee_robot;

struct Ended {
  int status;
  std::string output;  ///< both streams
};

class ChainPrograms : public ::testing::Test {
 protected:
  ChainPrograms() {
    std::ofstream(robot_) << "mechanism: chain\nurdf: "
                          << fs::absolute(KNEE_SOURCE_DIR "/test/dynamics/chain.urdf").string()
                          << "\nbase_link: base\ntip_link: tool\n";
  }

  std::string in(const std::string& name) const { return folder_ + "/" + name; }
  Ended run(const std::string& command) const {
    const int status = std::system((command + " > " + in("said") + " 2>&1").c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readFile(in("said"))};
  }
  Ended plan(const std::string& more) const {
    return run(std::string(KNEE_PLAN_EXCITATION) + " --robot " + robot_ + " --seconds 1 " + more + " -o " +
               in("motion.csv"));
  }
  Ended gains(const std::string& unloaded, const std::string& loaded, const std::string& more = "") const {
    return run(std::string(KNEE_DRIVE_GAINS) + " --robot " + robot_ + " --unloaded " + unloaded + " --loaded " +
               loaded + " --payload-kg 2.5 --output " + in("gains") + " " + more);
  }

  /// One sentence that holds `words`, exit status 2, nothing written.
  void expectBadInput(const Ended& ended, const std::string& words) const {
    EXPECT_EQ(ended.status, 2) << ended.output;
    EXPECT_NE(ended.output.find(words), std::string::npos) << ended.output;
    EXPECT_FALSE(fs::exists(in("motion.csv"))) << ended.output;
    EXPECT_FALSE(fs::exists(in("gains"))) << ended.output;
  }

  /// Two seconds of six joints at 100 Hz.
  std::string recorded(const std::string& name, const std::string& effort, int rows = 200) const {
    std::ofstream stream(in(name));
    stream << "time_s";
    for (int i = 1; i <= 6; ++i)
      stream << ",position_" << i << (i == 1 ? "_m" : "_rad");
    for (int i = 1; i <= 6; ++i)
      stream << ","
             << (effort == "current" ? "current"
                 : i == 1            ? "force"
                                     : "torque")
             << "_" << i
             << (effort == "current" ? "_A"
                 : i == 1            ? "_N"
                                     : "_Nm");
    for (int k = 0; k < rows; ++k) {
      stream << "\n" << 0.01 * k;
      for (int i = 0; i < 12; ++i)
        stream << "," << 0.001 * ((k * (i + 3)) % 50);
    }
    stream << "\n";
    return in(name);
  }

  const TemporaryFolder folder_;
  const std::string robot_ = folder_ + "/robot.yaml";
};

TEST_F(ChainPrograms, PlanExcitationRefusesShapesThatDoNotGoFromRestToRest) {
  for (const char* const more : {"--ramp 0", "--ramp -1"})
    expectBadInput(plan(more), "s is shorter than the 0.2 s");
  for (const char* const more : {"--ramp 100", "--duration 1", "--duration 0.05", "--duration -5", "--duration -1",
                                 "--duration 1e9", "--duration 1e5"})
    expectBadInput(plan(more), "is not between two ramps of");
  for (const char* const more : {"--ramp nan", "--duration nan", "--duration inf", "--seconds nan"})
    expectBadInput(plan(more), "is not a finite number");
  expectBadInput(plan("--harmonics 100000"), "harmonics 100000 is not in 1 to 30");
}

TEST_F(ChainPrograms, PlanExcitationRefusesWhatItWouldNotLookAt) {
  for (const char* const option : {"--velocity 0.1", "--acceleration 1", "--condition-max 10", "--directions 20",
                                   "--starts 2", "--iterations 10", "--criterion determinant", "--noise 1 1 1 1",
                                   "--viscous 1", "--coulomb 1", "--no-force-limits", "--twin-legs"}) {
    const std::string name = std::string(option).substr(0, std::string(option).find(' '));
    expectBadInput(plan(option), name + " is for the parallel robot, but " + robot_ + " describes a chain");
  }
  const Ended parallel = run(std::string(KNEE_PLAN_EXCITATION) + " --robot " KNEE_SOURCE_DIR "/config/robots/A.yaml" +
                             " --recorded run.csv -o " + in("motion.csv"));
  expectBadInput(parallel, "--recorded is for chains");
}

TEST_F(ChainPrograms, PlanExcitationWritesWhatItWasAskedFor) {
  const Ended planned = plan("--duration 6 --ramp 1 --harmonics 3");
  ASSERT_EQ(planned.status, 0) << planned.output;
  const std::string text = readFile(in("motion.csv"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 602) << "6 s, both ends included, and a header";
}

TEST_F(ChainPrograms, DriveGainsRefusesOneRecordingAsBoth) {
  const std::string run_1 = recorded("run.csv", "current"), other = recorded("other.csv", "current", 210);
  fs::copy_file(run_1, in("copy.csv"));
  expectBadInput(gains(run_1, run_1), "run.csv: is also given as recorded without the payload;");
  expectBadInput(gains(run_1, other + " " + in("copy.csv")), "copy.csv: is also given as recorded without the payload");
}

TEST_F(ChainPrograms, DriveGainsDoesNotWriteItsRobotFileOverTheOneThatItReads) {
  const std::string before = readFile(robot_);
  const Ended ended =
      run(std::string(KNEE_DRIVE_GAINS) + " --robot " + robot_ + " --unloaded " + recorded("run.csv", "current") +
          " --loaded " + recorded("other.csv", "current", 210) + " --payload-kg 2.5 --output " + folder_.path());
  expectBadInput(ended, "robot.yaml: is read, and would be overwritten");
  EXPECT_EQ(readFile(robot_), before);
}

TEST_F(ChainPrograms, DriveGainsSaysThatARecordingHasNoCurrents) {
  const std::string currents = recorded("currents.csv", "current"), torques = recorded("torques.csv", "torque");
  for (const Ended& ended : {gains(torques, currents), gains(currents, torques)}) {
    expectBadInput(ended, "torques.csv:1: has no currents");
    EXPECT_EQ(ended.output.find("robot file"), std::string::npos) << ended.output;
  }
}

TEST_F(ChainPrograms, DriveGainsRefusesACutOffThatFiltersNothing) {
  const std::string one = recorded("one.csv", "current"), two = recorded("two.csv", "current", 210);
  expectBadInput(gains(one, two, "--cutoff-hz 60"), "--cutoff-hz 60 filters nothing in " + one);
  expectBadInput(gains(one, two, "--cutoff-hz nan"), "nan is not a finite number");
}

}  // namespace
