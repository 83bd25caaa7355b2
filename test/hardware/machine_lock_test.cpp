#include "knee_robot/hardware/machine_lock.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "knee_robot/base/errors.h"
#include "test/refusal.h"

namespace knee_robot::hardware {
namespace {

struct Folder {
  std::string path = ::testing::TempDir() + "machine_lock_" + std::to_string(::getpid());
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

TEST(MachineLock, IsForOneOfEachRoleAndFreeAgainBehindIt) {
  const Folder folder;
  {
    const MachineLock controller = MachineLock::take("controller", "simulated /robot", folder.path);
    EXPECT_NO_THROW(MachineLock::take("guardian", "simulated /robot", folder.path));
    EXPECT_NO_THROW(MachineLock::take("controller", "simulated /other", folder.path));
    const std::string said = refusalOf([&] { MachineLock::take("controller", "simulated /robot", folder.path); });
    EXPECT_NE(said.find(std::to_string(::getpid())), std::string::npos) << said;
  }
  EXPECT_NO_THROW(MachineLock::take("controller", "simulated /robot", folder.path));
}

TEST(MachineLock, IsFreeAgainWhenItsProcessWasKilled) {
  const Folder folder;
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const MachineLock mine = MachineLock::take("controller", "pci", folder.path);
    const bool told = ::write(ready[1], "x", 1) == 1;
    ::pause();
    ::_exit(told ? 0 : 1);
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_THROW(MachineLock::take("controller", "pci", folder.path), InputError);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_NO_THROW(MachineLock::take("controller", "pci", folder.path));
}

TEST(MachineLock, HoldsWhenItsFileIsRemoved) {
  const Folder folder;
  const MachineLock mine = MachineLock::take("controller", "pci", folder.path);
  std::filesystem::remove_all(folder.path);
  std::filesystem::create_directories(folder.path);
  EXPECT_THROW(MachineLock::take("controller", "pci", folder.path), InputError);
}

TEST(MachineLock, IsSeenByWhoeverLooksAndTakenByNobodyWhoDoes) {
  const Folder folder;
  EXPECT_FALSE(MachineLock::isTaken("guardian", "pci", folder.path));
  {
    const MachineLock guardian = MachineLock::take("guardian", "pci", folder.path);
    EXPECT_TRUE(MachineLock::isTaken("guardian", "pci", folder.path));
    EXPECT_FALSE(MachineLock::isTaken("controller", "pci", folder.path));
    EXPECT_FALSE(MachineLock::isTaken("guardian", "other", folder.path));
  }
  EXPECT_FALSE(MachineLock::isTaken("guardian", "pci", folder.path));
}

TEST(MachineLock, SaysWhereItCannotBe) {
  EXPECT_THROW(MachineLock::take("controller", "pci", "/no/such/folder"), InputError);
}

}  // namespace
}  // namespace knee_robot::hardware
