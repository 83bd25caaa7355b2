// What programs write: never over what they read, all of it or nothing, and asked for before the work.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "knee_robot/base/files.h"
#include "test/nodes/bench_robot.h"

namespace {

namespace fs = std::filesystem;
using knee_robot::readFile, knee_robot::TemporaryFolder;

const std::string kPlatform = KNEE_SOURCE_DIR "/config/robots/B.yaml";

struct Finished {
  int status = -1;
  std::string said;
};

class Outputs : public ::testing::Test {
 protected:
  Outputs() : robot_(knee_robot::writeBenchRobot(folder_).string()) {
    record("run.csv", 0.0);
    record("other.csv", 0.4);
  }

  std::string in(const std::string& name) const { return folder_ + "/" + name; }

  /// Half a minute of the bench's two axes with friction.
  void record(const std::string& name, double phase) const {
    std::ofstream stream(in(name));
    stream << "time_s,reference_1_m,position_1_m,force_1_N,reference_2_m,position_2_m,force_2_N\n";
    for (int k = 0; k < 3000; ++k) {
      const double t = 0.01 * k + phase;
      const double q = 0.2 + 0.05 * std::sin(1.3 * t) + 0.02 * std::sin(3.1 * t);
      const double v = 0.065 * std::cos(1.3 * t) + 0.062 * std::cos(3.1 * t),
                   force = 200.0 * v + (v > 0 ? 30.0 : -30.0);
      stream << 0.01 * k << ',' << q << ',' << q << ',' << force << ',' << q << ',' << q << ',' << force << '\n';
    }
  }

  static Finished run(const std::string& command) {
    const TemporaryFolder aside;
    const std::string said = aside + "/said";
    const int status = std::system((command + " > /dev/null 2> " + said).c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readFile(said)};
  }
  Finished identify(const std::string& recordings, const std::string& output, const std::string& robot = "") const {
    return run(std::string(KNEE_IDENTIFY) + " --cutoff-hz 3 --robot " + (robot.empty() ? robot_ : robot) +
               " --output " + output + " --train " + recordings);
  }

  /// Status 2, one sentence with `words`, and every file as it was.
  void refuses(const std::string& command, const std::string& words) const {
    const auto before = contents();
    const Finished ended = run(command);
    EXPECT_EQ(ended.status, 2) << command << "\n" << ended.said;
    EXPECT_NE(ended.said.find(words), std::string::npos) << ended.said;
    EXPECT_EQ(std::count(ended.said.begin(), ended.said.end(), '\n'), 1) << ended.said;
    EXPECT_EQ(contents(), before) << command;
  }

  std::map<std::string, std::string> contents() const {
    std::map<std::string, std::string> out;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_.path()))
      out[entry.path().string()] = entry.is_regular_file() ? readFile(entry.path().string()) : "";
    return out;
  }

  const TemporaryFolder folder_;
  const std::string robot_;
};

TEST_F(Outputs, OfReportsAreNotWrittenOverWhatIsRead) {
  fs::rename(in("other.csv"), in("prediction_run.csv"));
  fs::copy_file(robot_, in("model.yaml"));
  fs::copy_file(in("run.csv"), in("report.json"));
  fs::create_directory_symlink(folder_.path(), in("link"));
  const std::string over = "would be overwritten";
  const std::string trains = " --train " + in("prediction_run.csv") + " --validate " + in("run.csv");
  for (const std::string& program : {std::string(KNEE_IDENTIFY), std::string(KNEE_TRACE)}) {
    refuses(program + " --robot " + robot_ + trains + " --output " + folder_.path(), over);
    refuses(program + " --robot " + robot_ + trains + " --output " + in("link"), over);
    refuses(program + " --robot " + in("model.yaml") + " --train " + in("run.csv") + " --output " + folder_.path(),
            over);
  }
  refuses(KNEE_COMPARE " --robot " + robot_ + " " + in("report.json") + " --output " + folder_.path(), over);
  refuses(KNEE_PREDICT " --robot " + robot_ + " --model " + in("report.json") + " " + in("run.csv") + " --output " +
              folder_.path(),
          over);
}

TEST_F(Outputs, OfReportsAreRefusedBeforeTheWorkWhereTheyHaveNoPlace) {
  for (const std::string& program : {std::string(KNEE_IDENTIFY), std::string(KNEE_TRACE)}) {
    const std::string command = program + " --robot " + robot_ + " --train " + in("run.csv") + " --output ";
    refuses(command + in("other.csv"), "cannot make this folder");
    refuses(command + "/proc/out", "cannot write into this folder");
  }
}

TEST_F(Outputs, OfPlansAreRefusedBeforeTheWorkWhereTheyHaveNoPlace) {
  const std::string plan = KNEE_PLAN_EXCITATION " --robot " + kPlatform + " -o ";
  refuses(plan + folder_.path(), "no regular file");
  refuses(plan + in("absent/plan.txt"), "cannot write");
  refuses(KNEE_PLAN_EXCITATION " --robot " + robot_ + " -o " + robot_, "would be overwritten");
  const std::string exercise = KNEE_PLAN_EXERCISE " hip_flexion --robot " + kPlatform + " -o " + in("hip.txt");
  refuses(exercise + " --picture /proc/x.svg", "/proc/x.svg");
  refuses(exercise + " --picture " + in("./hip.txt"), "--picture");
}

TEST_F(Outputs, OfSimulateAreNew) {
  const std::string config = KNEE_SOURCE_DIR "/config";
  const std::string command = KNEE_SIMULATE " " + in("run.csv") + " --robot " + kPlatform + " --simulation " + config +
                              "/simulation/B.yaml --hardware " + config + "/hardware/simulated.yaml --deployment " +
                              config + "/deployment/simulation.yaml -o ";
  refuses(command + in("run.csv"), "exists already");
  refuses(command + in("new.csv") + " --truth " + in("run.csv"), "exists already");
  refuses(command + in("new.csv") + " --truth " + in("./new.csv"), "is the recording's name");
}

/// A limit of a file's size stands for a full disk: the report does not fit.
TEST_F(Outputs, OfAnEarlierRunStayTogetherWhereTheDiskIsFull) {
  const std::string both = in("run.csv") + " --validate " + in("other.csv");
  ASSERT_EQ(identify(both, in("out")).status, 0);
  const auto before = contents();
  const std::string small = "trap '' XFSZ; ulimit -f 100; ";
  const Finished full = run("bash -c \"" + small + KNEE_IDENTIFY + " --cutoff-hz 4 --robot " + robot_ + " --output " +
                            in("out") + " --train " + both + "\"");
  EXPECT_EQ(full.status, 2) << full.said;
  EXPECT_EQ(contents(), before);
  EXPECT_EQ(identify(in("run.csv"), in("out")).status, 0);
  EXPECT_FALSE(fs::exists(in("out/prediction_other.csv"))) << "of a model that is no longer there";
}

TEST_F(Outputs, WantNamesThatAreNoOptionsAndNoNegativeSeeds) {
  const std::string train = " --robot " + robot_ + " --train " + in("run.csv");
  refuses(KNEE_IDENTIFY + train + " --output " + in("out") + " --validate --no-physical",
          "--validate: a value is missing");
  refuses(KNEE_IDENTIFY + train + " --output --joint-friction", "--output: a value is missing");
  refuses(KNEE_TRACE + train + " --output " + in("out") + " --seed -1", "-1 is negative");
}

TEST_F(Outputs, OfTraceKeepTheCutOffOfTheModelThatItStartsFrom) {
  const std::string command = KNEE_TRACE " --robot " + robot_ + " --train " + in("run.csv") + " --output " + in("out");
  refuses(command + " --model ''", "--model has an empty name");
  for (const std::string& option : {std::string("--cutoff-hz"), std::string("--motion-cutoff-hz")})
    refuses(command + " --model " + in("model.yaml") + " " + option + " 5", option + " does not go with --model");
}

}  // namespace
