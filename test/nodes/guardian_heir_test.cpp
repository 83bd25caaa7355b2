// A guardian that is killed, and what waits for that. In shared memory, as with the simulated robot's processes.
#include "../../src/nodes/guardian_heir.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <new>
#include <thread>

#include "knee_robot/simulation/simulated_cards.h"

namespace knee_robot::nodes {
namespace {

struct Shared {
  simulation::RobotImage image;
  hardware::GuardianLink link;
};

template <typename Condition>
bool comesTrue(Condition&& condition) {
  for (int ms = 0; ms < 5000; ++ms) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

class GuardiansHeir : public ::testing::Test {
 protected:
  GuardiansHeir() {
    void* memory = ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    shared_ = new (memory) Shared;
    const std::unique_ptr<hardware::AxisBus> cards = simulation::openImageCards(shared_->image);
    EXPECT_TRUE(cards->selfTest().passed);
    std::array<double, hardware::kAxes> written{};
    cards->writeVolts({3.0, 3.0, 3.0, 3.0}, written);
    cards->writeOutputs(3);  // drives on, brakes open
    shared_->link.armed.store(1);
  }
  ~GuardiansHeir() override { ::munmap(shared_, sizeof(Shared)); }

  hardware::GuardianLink& link() { return shared_->link; }
  bool isDown() const { return simulation::outputVolts(shared_->image.analog)[0] == 0.0; }

  /// A process that keeps an heir and counts its cycles.
  pid_t startGuardian() {
    const pid_t guardian = ::fork();
    if (guardian == 0) {
      keepHeir(link(), [this] {
        GuardianHeir heir;
        heir.outputs = simulation::openImageEmergencyOutputs(shared_->image);
        heir.carry = {1, 4, 30'000'000};
        return heir;
      });
      takeGuard(link());
      while (true) {
        link().guardian_cycles.fetch_add(1);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    }
    EXPECT_TRUE(comesTrue([&] { return link().guardian_pid.load() == guardian; }));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return guardian;
  }
  static void kill(pid_t process) {
    ::kill(process, SIGKILL);
    ::waitpid(process, nullptr, 0);
  }
  /// The number of a process that has died.
  static pid_t dead() {
    const pid_t process = ::fork();
    if (process == 0) ::_exit(0);
    ::waitpid(process, nullptr, 0);
    return process;
  }

  Shared* shared_ = nullptr;
};

TEST_F(GuardiansHeir, BringsDownWhatAControllerHasLeftThatDiedWithItsGuardian) {
  link().controller_pid.store(dead());
  const pid_t guardian = startGuardian();
  EXPECT_FALSE(isDown());
  kill(guardian);
  EXPECT_TRUE(comesTrue([&] { return isDown() && link().tripped.load() != 0; }));
  EXPECT_TRUE(comesTrue([&] { return link().guardian_pid.load() == 0; })) << "it is no guardian for longer than that";
}

TEST_F(GuardiansHeir, LeavesAControllerThatLivesTheTimeToStopByItself) {
  link().controller_pid.store(::getpid());
  const pid_t guardian = startGuardian();
  kill(guardian);
  for (int ms = 0; ms < 300; ++ms) {
    link().heartbeat.fetch_add(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_FALSE(isDown());
  EXPECT_EQ(link().tripped.load(), 0u);
  EXPECT_TRUE(comesTrue([&] { return isDown(); })) << "and no longer than it lives";
}

TEST_F(GuardiansHeir, TakesThePlaceOfAGuardianThatStandsStillWithItsController) {
  link().controller_pid.store(::getpid());
  const pid_t guardian = startGuardian();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_FALSE(isDown()) << "a controller that is silent is its guardian's";
  ::kill(guardian, SIGSTOP);
  EXPECT_TRUE(comesTrue([&] { return isDown() && link().tripped.load() != 0; }));
  EXPECT_TRUE(comesTrue([&] { return link().guardian_pid.load() == 0; })) << "the one that wakes up is replaced";
  kill(guardian);
}

TEST_F(GuardiansHeir, LeavesAGuardianThatStandsStillToAControllerThatLives) {
  link().controller_pid.store(::getpid());
  const pid_t guardian = startGuardian();
  ::kill(guardian, SIGSTOP);
  for (int ms = 0; ms < 400; ++ms) {
    link().heartbeat.fetch_add(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_FALSE(isDown());
  link().armed.store(0);
  kill(guardian);
}

TEST_F(GuardiansHeir, DoesNothingBesideTheNextGuardian) {
  link().controller_pid.store(dead());
  const pid_t guardian = startGuardian();
  const pid_t other = ::fork();
  if (other == 0) {
    ::pause();
    ::_exit(0);
  }
  link().guardian_pid.store(other);
  kill(guardian);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_FALSE(isDown());
  EXPECT_EQ(takeGuard(link()), other);
  kill(other);
  EXPECT_EQ(takeGuard(link()), 0);
}

}  // namespace
}  // namespace knee_robot::nodes
