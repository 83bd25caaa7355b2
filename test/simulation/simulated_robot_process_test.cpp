// The program simulated_robot, seen from outside: another process with the registers in shared memory.
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "knee_robot/base/errors.h"
#include "knee_robot/simulation/simulated_cards.h"

namespace knee_robot::simulation {
namespace {

using hardware::IoStatus;

/// A child process whose output can be read.
class Process {
 public:
  explicit Process(std::vector<std::string> arguments) {
    int ends[2];
    if (::pipe(ends) != 0) throw std::runtime_error("pipe");
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(ends[1], 1);
      ::dup2(ends[1], 2);
      ::close(ends[0]);
      std::vector<char*> words;
      for (std::string& argument : arguments)
        words.push_back(argument.data());
      words.push_back(nullptr);
      ::execv(words[0], words.data());
      ::_exit(127);
    }
    ::close(ends[1]);
    output_ = ends[0];
  }
  ~Process() {
    if (pid_ > 0) {
      ::kill(pid_, SIGTERM);  // lets it unlink its shared memory
      ::waitpid(pid_, nullptr, 0);
    }
    ::close(output_);
  }
  pid_t pid() const { return pid_; }
  /// Output up to and with the next line end, or what came in 10 s.
  std::string line() {
    std::string text;
    char letter = 0;
    pollfd waiting{output_, POLLIN, 0};
    while (::poll(&waiting, 1, 10000) == 1 && ::read(output_, &letter, 1) == 1) {
      if (letter == '\n') break;
      text += letter;
    }
    return text;
  }
  int exitStatus() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  pid_t pid_ = -1;
  int output_ = -1;
};

std::string shmName(const char* purpose) {
  return std::string("/knee_process_") + purpose + "_" + std::to_string(::getpid());
}

std::vector<std::string> command(const std::string& shm) {
  const std::string config = std::string(KNEE_SOURCE_DIR) + "/config";
  return {KNEE_SIMULATED_ROBOT,
          "--robot",
          config + "/robots/A.yaml",
          "--simulation",
          config + "/simulation/A.yaml",
          "--shm",
          shm};
}

/// Waits until the plant has made this many more steps.
bool awaitSteps(RobotImage& image, std::uint64_t steps) {
  const std::uint64_t until = image.plant_heartbeat.load() + steps;
  for (int i = 0; i < 10000 && image.plant_heartbeat.load() < until; ++i)
    ::usleep(1000);
  return image.plant_heartbeat.load() >= until;
}

TEST(SimulatedRobotProcess, OutlivesAKilledControllerAndIsFoundAgain) {
  const std::string name = shmName("kill");
  Process robot(command(name));
  ASSERT_NE(robot.line().find("ready"), std::string::npos);
  SharedImage memory = SharedImage::attach(name);
  const pid_t controller = ::fork();
  if (controller == 0) {
    const auto bus = openSimulatedCards(name);
    std::array<double, 4> written{};
    const bool good = bus->selfTest().passed && bus->writeVolts({1, 1, 1, 1}, written) == IoStatus::Ok &&
                      bus->writeOutputs(3) == IoStatus::Ok;
    if (!good) ::_exit(1);
    ::raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(controller, &status, 0), controller);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_TRUE(awaitSteps(memory.image(), 50));
  EXPECT_EQ(memory.image().counter.outputs.load(), 3);  // the drives are still on: a crash leaves the motors driven
  EXPECT_EQ(memory.image().status.drives_enabled.load(), 0x0F);
  const auto successor = openSimulatedCards(name);
  EXPECT_TRUE(successor->selfTest().passed);
  EXPECT_TRUE(awaitSteps(memory.image(), 100));
  EXPECT_EQ(memory.image().status.brakes_engaged.load(), 0x0F);
}

TEST(SimulatedRobotProcess, TakesItsCardsAwayWhenItIsAskedToEnd) {
  const std::string name = shmName("end");
  Process robot(command(name));
  ASSERT_NE(robot.line().find("ready"), std::string::npos);
  const auto bus = openSimulatedCards(name);
  ASSERT_TRUE(bus->selfTest().passed);
  ::kill(robot.pid(), SIGTERM);
  EXPECT_EQ(robot.exitStatus(), 0);
  hardware::AxisFeedback feedback;
  EXPECT_EQ(bus->read(feedback), IoStatus::Disconnected);
  EXPECT_THROW(openSimulatedCards(name), InputError);
}

TEST(SimulatedRobotProcess, RefusesASecondOneUnderTheSameNameAndBadFiles) {
  const std::string name = shmName("second");
  Process first(command(name));
  ASSERT_NE(first.line().find("ready"), std::string::npos);
  Process second(command(name));
  EXPECT_NE(second.line().find("already simulates"), std::string::npos);
  EXPECT_EQ(second.exitStatus(), 2);
  auto wrong = command(shmName("wrong"));
  wrong[4] = "/nowhere.yaml";
  Process third(wrong);
  EXPECT_NE(third.line().find("/nowhere.yaml"), std::string::npos);
  EXPECT_EQ(third.exitStatus(), 2);
}

TEST(SimulatedRobotProcess, EndsAfterItsDuration) {
  auto words = command(shmName("duration"));
  words.insert(words.end(), {"--duration", "0.2", "__name:=simulated_robot"});
  Process robot(words);
  EXPECT_NE(robot.line().find("ready"), std::string::npos);
  EXPECT_NE(robot.line().find("ends after 0.2"), std::string::npos);
  EXPECT_EQ(robot.exitStatus(), 0);
}

}  // namespace
}  // namespace knee_robot::simulation
