// identify and plan_excitation run as programs: exit statuses, one sentence, no half-written files, Ctrl-C.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <thread>

#include "knee_robot/trajectory/reference_file.h"
#include "test/nodes/bench_robot.h"

namespace {

namespace fs = std::filesystem;
using knee_robot::TemporaryFolder, knee_robot::writeBenchRobot;

std::string contentOf(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

using Signal = std::function<double(double)>;

double sineMotion(double t) {
  return 0.2 + 0.05 * std::sin(1.3 * t) + 0.02 * std::sin(3.1 * t);
}
double rubbing(double t) {
  const double v = 0.065 * std::cos(1.3 * t) + 0.062 * std::cos(3.1 * t);
  return 200.0 * v + (v > 0.0 ? 30.0 : -30.0);
}

fs::path writeRecording(const TemporaryFolder& folder, double seconds, const Signal& second_position,
                        const Signal& force) {
  const fs::path file = folder / "recording.csv";
  std::ofstream stream(file);
  stream << "time_s,reference_1_m,position_1_m,force_1_N,reference_2_m,position_2_m,force_2_N\n";
  for (int k = 0; k < seconds * 100.0; ++k) {
    const double t = 0.01 * k;
    stream << t << ',' << sineMotion(t) << ',' << sineMotion(t) << ',' << force(t + 0.005) << ',' << second_position(t)
           << ',' << second_position(t) << ',' << force(t + 0.005) << '\n';
  }
  return file;
}

struct Ended {
  int status = -1;
  std::string errors;
};

/// Runs `identify` on the recording; cut-off given, because a few seconds do not show a spectrum.
Ended identify(const TemporaryFolder& folder, const fs::path& robot, const fs::path& recording,
               const std::string& more = "", const std::string& cutoff_hz = "3") {
  const fs::path errors = folder / "errors.txt";
  const std::string command = std::string(KNEE_IDENTIFY) + " --robot " + robot.string() + " --train " +
                              recording.string() + " --cutoff-hz " + cutoff_hz + " --output " +
                              (folder / "out").string() + " " + more + " > /dev/null 2> " + errors.string();
  const int status = WEXITSTATUS(std::system(command.c_str()));
  return {status, contentOf(errors)};
}

/// Refused with exit status 3, one sentence that holds `words`, and nothing written.
void expectRefusal(const TemporaryFolder& folder, const Ended& ended, const std::string& words) {
  EXPECT_EQ(ended.status, 3) << ended.errors;
  std::istringstream lines(ended.errors);
  std::string line;
  int sentences = 0;
  while (std::getline(lines, line)) {
    if (line.rfind("identify: ", 0) != 0) continue;  // progress
    ++sentences;
    EXPECT_NE(line.find(words), std::string::npos) << line;
  }
  EXPECT_EQ(sentences, 1) << ended.errors;
  EXPECT_FALSE(fs::exists(folder / "out" / "model.yaml"));
}

TEST(IdentifyProgram, WritesItsFilesAndEndsWithZero) {
  const TemporaryFolder folder;
  const Ended ended = identify(folder, writeBenchRobot(folder), writeRecording(folder, 30.0, sineMotion, rubbing));
  EXPECT_EQ(ended.status, 0) << ended.errors;
  for (const char* name : {"model.yaml", "report.json", "report.html"})
    EXPECT_TRUE(fs::exists(folder / "out" / name)) << name;
}

TEST(IdentifyProgram, RefusesWhatIsTooShort) {
  const TemporaryFolder folder;
  expectRefusal(folder, identify(folder, writeBenchRobot(folder), writeRecording(folder, 1.9, sineMotion, rubbing)),
                "s of usable motion");
  expectRefusal(folder, identify(folder, writeBenchRobot(folder), writeRecording(folder, 0.1, sineMotion, rubbing)),
                "rows are too few");
}

TEST(IdentifyProgram, RefusesAnAxisWithoutMotion) {
  const TemporaryFolder folder;
  const Signal rest = [](double) { return 0.2; };
  expectRefusal(folder, identify(folder, writeBenchRobot(folder), writeRecording(folder, 30.0, rest, rubbing)),
                "actuator 2 does not move in");
}

TEST(IdentifyProgram, RefusesAMotionWithoutForces) {
  const TemporaryFolder folder;
  const Signal off = [](double) { return 0.0; };
  expectRefusal(folder, identify(folder, writeBenchRobot(folder), writeRecording(folder, 30.0, sineMotion, off)),
                "actuator 1 moves, but every row has the same force (0 N): its drive was off");
}

TEST(IdentifyProgram, RefusesSaturatedCommands) {
  const TemporaryFolder folder;
  const Signal saturated = [](double t) { return std::fmod(t, 3.0) < 1.0 ? 300.0 : rubbing(t); };
  expectRefusal(folder, identify(folder, writeBenchRobot(folder), writeRecording(folder, 30.0, sineMotion, saturated)),
                "a command is at its limit");
}

TEST(IdentifyProgram, RefusesMoreDirectionsThanTheMotionExcites) {
  const TemporaryFolder folder;
  expectRefusal(
      folder, identify(folder, writeBenchRobot(folder), writeRecording(folder, 30.0, sineMotion, rubbing), "--rank 50"),
      "50 directions were asked for");
}

TEST(IdentifyProgram, EndsWithTwoOnBadInput) {
  const TemporaryFolder folder;
  const Ended ended = identify(folder, writeBenchRobot(folder), folder / "absent.csv");
  EXPECT_EQ(ended.status, 2) << ended.errors;
}

/// 100 rows a second: from 45 Hz on the low-pass leaves everything as it is.
TEST(IdentifyProgram, RefusesACutOffThatFiltersNothing) {
  const TemporaryFolder folder;
  const fs::path robot = writeBenchRobot(folder), train = writeRecording(folder, 5.0, sineMotion, rubbing);
  for (const char* const cutoff : {"45", "60", "1e5"}) {
    const Ended ended = identify(folder, robot, train, "", cutoff);
    EXPECT_EQ(ended.status, 2) << ended.errors;
    EXPECT_NE(ended.errors.find("filters nothing in " + train.string() + " with its 100 rows a second"),
              std::string::npos)
        << ended.errors;
  }
  const Ended ended = identify(folder, robot, train, "", "nan");
  EXPECT_EQ(ended.status, 2) << ended.errors;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

/// Whatever it is called: by another path, through a link, as a copy.
TEST(IdentifyProgram, AndTraceRefuseToValidateAModelWithWhatItIsFittedTo) {
  const TemporaryFolder folder;
  const fs::path robot = writeBenchRobot(folder), train = writeRecording(folder, 5.0, sineMotion, rubbing);
  const fs::path copy = folder / "copy.csv", link = folder / "link.csv", other = folder / "other.csv";
  fs::copy_file(train, copy);
  fs::create_symlink(train, link);
  std::ofstream(other) << contentOf(train) << "5.0,0.2,0.2,1,0.2,0.2,1\n";
  const auto validate = [&](const std::string& program, const std::string& with) {
    const fs::path errors = folder / "errors.txt";
    const std::string command = program + " --robot " + robot.string() + " --train " + train.string() + " --output " +
                                (folder / "out").string() + " --validate " + with + " > /dev/null 2> " +
                                errors.string();
    const int status = WEXITSTATUS(std::system(command.c_str()));
    return Ended{status, contentOf(errors)};
  };
  const std::string by_another_path = train.parent_path().string() + "/./" + train.filename().string();
  for (const std::string program : {KNEE_IDENTIFY, KNEE_TRACE}) {
    for (const std::string& again : {train.string(), by_another_path, copy.string(), link.string()}) {
      const Ended ended = validate(program, other.string() + " " + again);
      EXPECT_EQ(ended.status, 2) << again << ": " << ended.errors;
      EXPECT_NE(ended.errors.find(again + ": is the recording that the model is fitted to"), std::string::npos)
          << ended.errors;
      EXPECT_EQ(std::count(ended.errors.begin(), ended.errors.end(), '\n'), 1) << ended.errors;
    }
    fs::create_directory(folder / "beside");
    fs::copy_file(other, folder / "beside" / "other.csv", fs::copy_options::overwrite_existing);
    const Ended twice = validate(program, other.string() + " " + (folder / "beside" / "other.csv").string());
    EXPECT_EQ(twice.status, 2) << twice.errors;
    EXPECT_NE(twice.errors.find("another validation file is named other too"), std::string::npos) << twice.errors;
  }
}

TEST(IdentifyProgram, AndTraceRefuseARecordingThatIsGivenTwiceToFitTo) {
  const TemporaryFolder folder;
  const fs::path robot = writeBenchRobot(folder), train = writeRecording(folder, 5.0, sineMotion, rubbing);
  const fs::path copy = folder / "copy.csv", errors = folder / "errors.txt";
  fs::copy_file(train, copy);
  for (const std::string program : {KNEE_IDENTIFY, KNEE_TRACE}) {
    for (const fs::path& again : {train, copy}) {
      const std::string command = program + " --robot " + robot.string() + " --train " + train.string() + " " +
                                  again.string() + " --output " + (folder / "out").string() + " > /dev/null 2> " +
                                  errors.string();
      EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2);
      EXPECT_NE(contentOf(errors).find(again.string() + ": is given twice to fit to"), std::string::npos)
          << contentOf(errors);
    }
  }
}

/// A copy with other line ends, and one that has lost its last rows.
TEST(IdentifyProgram, AndTraceRefuseOneMeasurementInTwoFormats) {
  const TemporaryFolder folder;
  const fs::path robot = writeBenchRobot(folder), train = writeRecording(folder, 5.0, sineMotion, rubbing);
  const fs::path copy = folder / "copy.csv", shorter = folder / "shorter.csv", errors = folder / "errors.txt";
  const std::string text = contentOf(train);
  std::istringstream lines(text);
  std::ofstream written(copy);
  for (std::string line; std::getline(lines, line);)
    written << line << "\r\n";
  written.close();
  std::ofstream(shorter) << text.substr(0, text.rfind('\n', text.size() - 200) + 1);
  for (const std::string program : {KNEE_IDENTIFY, KNEE_TRACE}) {
    for (const fs::path& again : {copy, shorter}) {
      for (const std::string use : {" ", " --validate "}) {
        const std::string command = program + " --robot " + robot.string() + " --output " + (folder / "out").string() +
                                    " --train " + train.string() + use + again.string() + " > /dev/null 2> " +
                                    errors.string();
        EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2) << command;
        EXPECT_NE(contentOf(errors).find(again.string() + ": has the times and positions of " + train.string()),
                  std::string::npos)
            << contentOf(errors);
      }
    }
  }
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(IdentifyProgram, RefusesRowsThatAreTooSlowForACutOff) {
  const TemporaryFolder folder;
  const fs::path robot = writeBenchRobot(folder), slow = folder / "slow.csv", errors = folder / "errors.txt";
  std::istringstream lines(contentOf(writeRecording(folder, 60.0, sineMotion, rubbing)));
  std::ofstream written(slow);
  std::string line;
  for (int k = 0; std::getline(lines, line); ++k) {
    if (k == 0 || k % 20 == 1) written << line << '\n';
  }
  written.close();
  const std::string command = std::string(KNEE_IDENTIFY) + " --robot " + robot.string() + " --train " + slow.string() +
                              " --output " + (folder / "out").string() + " > /dev/null 2> " + errors.string();
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 3);
  EXPECT_NE(contentOf(errors).find("5 rows a second are too slow for a cut-off of 1 Hz"), std::string::npos)
      << contentOf(errors);
}

TEST(PlanExcitationProgram, WritesAMovementNearRestAndTakesNoOptionOfASeriesForIt) {
  const TemporaryFolder folder;
  const fs::path output = folder / "near_rest.txt", errors = folder / "errors.txt";
  const auto plan = [&](const std::string& options) {
    const std::string command = std::string(KNEE_PLAN_EXCITATION) +
                                " --robot " KNEE_SOURCE_DIR "/config/robots/A.yaml " + options + " -o " +
                                output.string() + " > /dev/null 2> " + errors.string();
    return WEXITSTATUS(std::system(command.c_str()));
  };
  EXPECT_EQ(plan("--near-rest --harmonics 3"), 2);
  EXPECT_NE(contentOf(errors).find("--harmonics is for the Fourier series"), std::string::npos) << contentOf(errors);
  EXPECT_EQ(plan("--places 3"), 2);
  EXPECT_NE(contentOf(errors).find("--places is for --near-rest"), std::string::npos) << contentOf(errors);
  EXPECT_EQ(plan("--near-rest --duration 1"), 2);
  EXPECT_FALSE(fs::exists(output)) << "nothing is written where nothing was planned";
  ASSERT_EQ(plan("--near-rest --duration 40 --places 3"), 0) << contentOf(errors);
  EXPECT_NEAR(static_cast<double>(knee_robot::trajectory::readReference(output.string()).points.rows()), 4000.0, 10.0);
}

/// Ctrl-C while it searches: the best so far is written whole, and that is a plan like any other: status 0.
TEST(PlanExcitationProgram, WritesTheBestSoFarOnInterruptAndEndsWithZero) {
  const TemporaryFolder folder;
  const std::string output = (folder / "plan.txt").string(), log = (folder / "log.txt").string();
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    if (std::freopen(log.c_str(), "a", stderr) == nullptr || std::freopen(log.c_str(), "a", stdout) == nullptr)
      ::_exit(100);
    ::execl(KNEE_PLAN_EXCITATION, "plan_excitation", "--robot", KNEE_SOURCE_DIR "/config/robots/A.yaml", "--seconds",
            "100000", "--iterations", "100000", "-o", output.c_str(), static_cast<char*>(nullptr));
    ::_exit(101);
  }
  const fs::path progress = folder / "log.txt";
  while (contentOf(progress).find("random") == std::string::npos && ::waitpid(child, nullptr, WNOHANG) == 0)
    std::this_thread::sleep_for(
        std::chrono::milliseconds(20));  // it has found something: from then on it may be stopped
  EXPECT_FALSE(fs::exists(output)) << "nothing may be there before it is whole";
  ASSERT_EQ(::kill(child, SIGINT), 0);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0) << contentOf(progress);
  EXPECT_NE(contentOf(progress).find("stopped early: best so far"), std::string::npos);
  const knee_robot::trajectory::Reference reference = knee_robot::trajectory::readReference(output);
  EXPECT_EQ(reference.points.rows(), 2001) << "20 s, to the end";
}

}  // namespace
