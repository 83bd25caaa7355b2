// The tuning assistant as an engineer calls it, on the simulated robot whose inertia is known.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

#include "knee_robot/base/files.h"
#include "knee_robot/control/axis_inertia.h"
#include "test/temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using namespace knee_robot;

const std::string kConfig = std::string(KNEE_SOURCE_DIR) + "/config";
const std::string kRobot = " --robot " + kConfig + "/robots/A.yaml ";
constexpr double kRotor_kg = 5.6;  // config/simulation/A.yaml

struct Ended {
  int status;
  std::string output;
};

class TunePid : public ::testing::Test {
 protected:
  std::string in(const std::string& name) const { return folder_ + "/" + name; }
  Ended run(const std::string& command) const {
    const int status = std::system((command + " > " + in("said") + " 2>&1").c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readFile(in("said"))};
  }
  Ended tune(const std::string& recording) const {
    return run(KNEE_TUNE_PID + kRobot + "--deployment " + kConfig + "/deployment/simulation.yaml " + recording +
               " --output " + in("tuned"));
  }
  const TemporaryFolder folder_;
};

TEST_F(TunePid, FindsTheSimulatedRobotsInertiaFromItsOwnReferenceAndProposesOnlyWhatKeepsTheMargin) {
  const Ended wrote = run(KNEE_TUNE_PID + kRobot + "--write-reference " + in("quick.txt"));
  ASSERT_EQ(0, wrote.status) << wrote.output;
  const Ended checked = run(KNEE_CHECK_REFERENCE + (" " + in("quick.txt")) + kRobot);
  ASSERT_EQ(0, checked.status) << checked.output;
  const Ended played = run(KNEE_SIMULATE + kRobot + "--simulation " + kConfig + "/simulation/A.yaml --hardware " +
                           kConfig + "/hardware/simulated.yaml --deployment " + kConfig +
                           "/deployment/simulation.yaml " + in("quick.txt") + " -o " + in("quick.csv"));
  ASSERT_EQ(0, played.status) << played.output;
  const Ended tuned = tune(in("quick.csv"));
  ASSERT_EQ(0, tuned.status) << tuned.output;
  const mechanism::Robot robot = mechanism::loadRobot(kConfig + "/robots/A.yaml");
  const control::AxisInertia truth =
      control::axisInertia(robot, dynamics::loadRobotInertia(robot), {0.0, 0.6, 0.0, 0.0}, 0.0);
  const std::regex line("leg (\\d) \\(Driver\\d\\)\n  measured    ([0-9.e+]+) \\+- ([0-9.e+-]+) kg");
  int measured = 0;
  for (std::sregex_iterator one(tuned.output.begin(), tuned.output.end(), line), end; one != end; ++one, ++measured) {
    const int leg = std::stoi((*one)[1]) - 1;
    const double mass = std::stod((*one)[2]);
    // The other legs are held by their loops: between locked and free, and nearer to locked.
    EXPECT_GT(mass, truth.free()[leg] + kRotor_kg) << tuned.output;
    EXPECT_LT(mass, 1.1 * (truth.locked()[leg] + kRotor_kg)) << tuned.output;
  }
  EXPECT_GE(measured, 2) << tuned.output;
  EXPECT_TRUE(fs::exists(in("tuned/report.html")) && fs::exists(in("tuned/gains.yaml")));
  EXPECT_NE(readFile(in("tuned/report.json")).find("\"command\": \"tune_pid\""), std::string::npos);
}

TEST_F(TunePid, RefusesAMovementThatShowsNoInertiaInOneSentence) {
  std::ofstream file(in("slow.csv"));
  file << "time_s";
  for (int i = 1; i <= 4; ++i)
    file << ",position_" << i << "_m,force_" << i << "_N";
  file << '\n';
  for (int k = 0; k < 5000; ++k) {
    file << 0.001 * k;
    for (int i = 0; i < 4; ++i)
      file << ',' << 0.62 + 0.01 * 0.001 * k << ',' << 20.0;
    file << '\n';
  }
  file.close();
  const Ended tuned = tune(in("slow.csv"));
  EXPECT_EQ(3, tuned.status) << tuned.output;
  EXPECT_NE(tuned.output.find("no axis can be judged"), std::string::npos) << tuned.output;
  EXPECT_FALSE(fs::exists(in("tuned"))) << "nothing half-written";
}

TEST_F(TunePid, SaysWhatItNeeds) {
  EXPECT_EQ(2, run(KNEE_TUNE_PID + kRobot).status);
  EXPECT_EQ(2, tune(in("no_such.csv")).status);
  EXPECT_EQ(2, run(KNEE_TUNE_PID + kRobot + "--write-reference " + in("no/such/folder/q.txt")).status);
}

}  // namespace
