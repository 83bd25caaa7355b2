#include "knee_robot/hardware/guardian_link.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <utility>

#include "card_bench.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/hardware/guarded_bus.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "test/refusal.h"

namespace knee_robot::hardware {
namespace {

bool nameExists(const std::string& name) {
  return ::access(("/dev/shm" + name).c_str(), F_OK) == 0;
}

TEST(GuardianLink, IsOneForWhoeverComesFirst) {
  const std::string name = uniqueShmName("link");
  SharedGuardianLink one = SharedGuardianLink::open(name);
  SharedGuardianLink other = SharedGuardianLink::open(name);
  one.link().heartbeat.store(7);
  EXPECT_EQ(other.link().heartbeat.load(), 7u);
}

TEST(GuardianLink, OfAnotherUserIsRefusedWithWhatToDo) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can become somebody else";
  const std::string name = uniqueShmName("link");
  const SharedGuardianLink of_root = SharedGuardianLink::open(name);
  ASSERT_EQ(::seteuid(65534), 0);
  const std::string refusal = refusalOf([&] { SharedGuardianLink::open(name); });
  ASSERT_EQ(::seteuid(0), 0);
  EXPECT_NE(refusal.find("belongs to another user"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("remove it from /dev/shm"), std::string::npos) << refusal;
}

TEST(GuardianLink, ThatOthersMayWriteIsRefused) {
  // Whoever writes it tells the guardian what the drives are to be given.
  const std::string name = uniqueShmName("link");
  const int file = ::shm_open(name.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
  ASSERT_GE(file, 0);
  const auto refusal = [&] { return refusalOf([&] { SharedGuardianLink::open(name); }); };
  ASSERT_EQ(::fchmod(file, 0666), 0);
  EXPECT_NE(refusal().find("other users may write it"), std::string::npos) << refusal();
  ASSERT_EQ(::fchmod(file, 0600), 0);
  if (::fchown(file, 65534, 65534) == 0) {
    EXPECT_NE(refusal().find("other users may write it"), std::string::npos) << refusal();
    ASSERT_EQ(::fchown(file, ::geteuid(), ::getegid()), 0);
  }
  EXPECT_NO_THROW(SharedGuardianLink::open(name));
  ::close(file);
  ::shm_unlink(name.c_str());
}

TEST(GuardianLink, KnowsThatItsNameWasRemovedAndLeavesAnothersAlone) {
  const std::string name = uniqueShmName("link");
  auto first = std::make_unique<SharedGuardianLink>(SharedGuardianLink::open(name));
  EXPECT_TRUE(first->isNamed());
  ASSERT_EQ(::shm_unlink(name.c_str()), 0);
  EXPECT_FALSE(first->isNamed());
  SharedGuardianLink second = SharedGuardianLink::open(name);
  EXPECT_FALSE(first->isNamed()) << "the name is another one's now";
  EXPECT_TRUE(second.isNamed());
  first.reset();
  EXPECT_TRUE(nameExists(name)) << "who lost its name removes nobody else's";
}

TEST(GuardianLink, OutlivesEachOfTheTwoAndGoesWithTheLast) {
  const std::string name = uniqueShmName("link");
  {
    SharedGuardianLink guardian = SharedGuardianLink::open(name);
    guardian.link().guardian_pid.store(1);  // a process that lives: init
    guardian.link().tripped.store(1);
    guardian.link().controller_pid.store(::getpid());
  }
  ASSERT_TRUE(nameExists(name));
  {
    SharedGuardianLink again = SharedGuardianLink::open(name);
    EXPECT_EQ(again.link().tripped.load(), 1u) << "the latch is kept";
    EXPECT_EQ(again.link().controller_pid.load(), 0) << "taken out by its own end";
    again.link().guardian_pid.store(::getpid());
  }
  EXPECT_FALSE(nameExists(name));
}

TEST(GuardianLink, RefusesWhatIsNone) {
  EXPECT_THROW(SharedGuardianLink::open("without_slash"), InputError);
  const std::string name = uniqueShmName("link");
  {
    simulation::SharedImage image = simulation::SharedImage::create(name);
    EXPECT_THROW(SharedGuardianLink::open(name), InputError);
  }
}

TEST(GuardedBus, RefusesAGuardianOfAnotherMachineOrAnotherWiring) {
  EXPECT_NE(machineMark("pci 0 0"), machineMark("pci 0 1"));
  for (const auto& [same, wired] : {std::pair{true, true}, std::pair{false, true}, std::pair{true, false}}) {
    simulation::RobotImage image;
    GuardianLink link;
    link.machine.store(machineMark("pci 0 0"));
    link.wiring.store(machineMark("0 1 2"));
    const std::unique_ptr<AxisBus> cards = simulation::openImageCards(image);
    GuardedBus::Options options;
    options.machine = machineMark(same ? "pci 0 0" : "pci 0 1");
    options.wiring = machineMark(wired ? "0 1 2" : "1 0 2");
    GuardedBus bus(*cards, link, 3, options);
    std::atomic<bool> done{false};
    std::thread guardian([&] {
      while (!done)
        link.reset_done.store(link.reset_request.load());
    });
    const SelfTest test = bus.selfTest();
    done = true;
    guardian.join();
    EXPECT_EQ(test.passed, same && wired);
    if (test.passed) continue;
    EXPECT_NE(test.findings.back().find(same ? "other outputs or brakes" : "another machine"), std::string::npos)
        << test.findings.back();
  }
}

TEST(GuardedBus, RefusesToStartWithoutAGuardian) {
  simulation::RobotImage image;
  GuardianLink link;
  const std::unique_ptr<AxisBus> cards = simulation::openImageCards(image);
  GuardedBus bus(*cards, link, 3);
  const SelfTest test = bus.selfTest();
  EXPECT_FALSE(test.passed);
  ASSERT_FALSE(test.findings.empty());
  EXPECT_NE(test.findings.back().find("guardian"), std::string::npos);
}

TEST(GuardedBus, KnowsTheLongerOfTheSilencesThatTheTwoAllowEachOther) {
  simulation::RobotImage image;
  GuardianLink link;
  const std::unique_ptr<AxisBus> cards = simulation::openImageCards(image);
  EXPECT_EQ(cards->allowedSilence(), 0);
  GuardedBus bus(*cards, link, 3);
  EXPECT_EQ(bus.allowedSilence(), 50'000'000) << "its own";
  link.silence_ns.store(10'000'000'000);
  EXPECT_EQ(bus.allowedSilence(), 10'000'000'000);
}

TEST(GuardedBus, RefusesASecondController) {
  simulation::RobotImage image;
  GuardianLink link;
  link.controller_pid.store(1);  // init lives
  const std::unique_ptr<AxisBus> cards = simulation::openImageCards(image);
  GuardedBus bus(*cards, link, 3);
  const SelfTest test = bus.selfTest();
  EXPECT_FALSE(test.passed);
  EXPECT_NE(test.findings.back().find("already controls"), std::string::npos);
  EXPECT_EQ(link.controller_pid.load(), 1);
}

TEST(GuardedBus, IsArmedBeforeTheDrivesGetPowerAndDisarmedAfterTheyLostIt) {
  simulation::RobotImage image;
  GuardianLink link;
  const std::unique_ptr<AxisBus> cards = simulation::openImageCards(image);
  ASSERT_TRUE(cards->selfTest().passed);
  GuardedBus bus(*cards, link, 3);
  EXPECT_EQ(bus.writeOutputs(4), IoStatus::Ok);
  EXPECT_EQ(link.armed.load(), 0u) << "the heartbeat alone is no power";
  EXPECT_EQ(bus.writeOutputs(1), IoStatus::Ok);
  EXPECT_EQ(link.armed.load(), 1u);
  image.counter.disconnected.store(1);
  EXPECT_NE(bus.writeOutputs(0), IoStatus::Ok);
  EXPECT_EQ(link.armed.load(), 1u) << "the write failed: the drives may still be on";
  image.counter.disconnected.store(0);
  EXPECT_EQ(bus.writeOutputs(0), IoStatus::Ok);
  EXPECT_EQ(link.armed.load(), 0u);
  EXPECT_EQ(link.heartbeat.load(), 4u);
}

/// Drives on and brakes open, as a controller that died left them.
void leaveOn(simulation::RobotImage& image, GuardianLink& link) {
  const std::unique_ptr<AxisBus> cards = simulation::openImageCards(image);
  ASSERT_TRUE(cards->selfTest().passed);
  std::array<double, kAxes> written{};
  cards->writeVolts({3.0, 3.0, 3.0, 3.0}, written);
  cards->writeOutputs(3);
  link.armed.store(1);
  link.controller_pid.store(0x3ffffff);  // nobody has that number
}

TEST(GuardedBus, BringsDownWhatADeadControllerLeftOnEvenWhenNoGuardianAnswers) {
  simulation::RobotImage image;
  GuardianLink link;
  leaveOn(image, link);
  const std::unique_ptr<AxisBus> cards = simulation::openImageCards(image);
  const std::unique_ptr<EmergencyOutputs> outputs = simulation::openImageEmergencyOutputs(image);
  GuardedBus::Options options;
  options.outputs = outputs.get();
  GuardedBus bus(*cards, link, 3, options);
  EXPECT_FALSE(bus.selfTest().passed);
  EXPECT_EQ(image.counter.outputs.load(), 0);
  EXPECT_EQ(simulation::outputVolts(image.analog)[0], 0.0);
  EXPECT_EQ(link.armed.load(), 0u);
}

/// Outputs at the moment at which a guardian has handed over, `hand_over_ms` after a new controller has asked for them
/// (or when that has given up), and whether that one gets them then. `gone_ms`: for so long after 50 ms there is no
/// guardian, and then another one.
std::pair<unsigned, bool> startedWithinAHandOver(int hand_over_ms, int gone_ms = 0) {
  simulation::RobotImage image;
  GuardianLink link;
  leaveOn(image, link);
  link.guardian_pid.store(::getpid());
  link.tripped.store(1);
  link.acts.store(1);
  const std::unique_ptr<AxisBus> cards = simulation::openImageCards(image);
  const std::unique_ptr<EmergencyOutputs> outputs = simulation::openImageEmergencyOutputs(image);
  GuardedBus::Options options;
  options.outputs = outputs.get();
  GuardedBus bus(*cards, link, 3, options);
  std::atomic<bool> done{false};
  unsigned carried = 0;
  std::thread guardian([&] {
    for (int cycle = 0; !done; ++cycle) {
      std::this_thread::sleep_for(std::chrono::milliseconds(cycle == 10 ? 60 : 1));  // a busy machine
      if (gone_ms > 0 && cycle == 50) {
        link.guardian_pid.store(0x3ffffff);  // nobody has that number
        std::this_thread::sleep_for(std::chrono::milliseconds(gone_ms));
        link.guardian_pid.store(1);
      }
      if (cycle == hand_over_ms) {
        carried = image.counter.outputs.load();
        link.acts.store(0);
      }
      if (cycle >= hand_over_ms && link.reset_request.load() != link.reset_done.load()) {
        link.tripped.store(0);
        link.reset_done.store(link.reset_request.load());
      }
      link.guardian_cycles.fetch_add(1);
    }
  });
  const bool passed = bus.selfTest().passed;
  done = true;
  guardian.join();
  return {link.acts.load() != 0 ? image.counter.outputs.load() : carried, passed};
}

TEST(GuardedBus, LeavesToTheGuardianWhatItHandsOverToTheBrakesAndStartsThen) {
  const auto [carried, passed] = startedWithinAHandOver(600);
  EXPECT_EQ(carried, 3u) << "the drives carried until the brakes held";
  EXPECT_TRUE(passed) << "a controller that is started meanwhile waits";
}

TEST(GuardedBus, DoesNotTakeThePlatformFromAGuardianThatStillCarriesIt) {
  const auto [carried, passed] = startedWithinAHandOver(100'000);
  EXPECT_FALSE(passed);
  EXPECT_EQ(carried, 3u);
}

TEST(GuardedBus, WaitsForAnotherGuardianWhereOneHasDiedOfAHandOver) {
  const auto [carried, passed] = startedWithinAHandOver(600, 1200);
  EXPECT_EQ(carried, 3u) << "once brought down at once: brakes that are late do not hold yet";
  EXPECT_TRUE(passed);
}

TEST(GuardedBus, BringsDownWhatAGuardianThatHasDiedLeftOnWhenNoOtherComes) {
  simulation::RobotImage image;
  GuardianLink link;
  leaveOn(image, link);
  link.guardian_pid.store(0x3ffffff);
  link.tripped.store(1);
  link.acts.store(1);
  const std::unique_ptr<AxisBus> cards = simulation::openImageCards(image);
  const std::unique_ptr<EmergencyOutputs> outputs = simulation::openImageEmergencyOutputs(image);
  GuardedBus::Options options;
  options.outputs = outputs.get();
  GuardedBus bus(*cards, link, 3, options);
  EXPECT_FALSE(bus.selfTest().passed);
  EXPECT_EQ(image.counter.outputs.load(), 0);
  EXPECT_EQ(link.acts.load(), 0u) << "no guardian that comes now switches on again what is off";
}

TEST(GuardedBus, StaysArmedWhenTheCardsDoNotLetItBringTheOutputsDown) {
  simulation::RobotImage image;
  GuardianLink link;
  leaveOn(image, link);
  image.counter.disconnected.store(1);
  const std::unique_ptr<AxisBus> cards = simulation::openImageCards(image);
  const std::unique_ptr<EmergencyOutputs> outputs = simulation::openImageEmergencyOutputs(image);
  GuardedBus::Options options;
  options.outputs = outputs.get();
  GuardedBus bus(*cards, link, 3, options);
  EXPECT_FALSE(bus.selfTest().passed);
  EXPECT_EQ(link.armed.load(), 1u) << "a guardian that comes now must act";
}

std::int64_t& testTime() {
  static std::int64_t time = 0;
  return time;
}
std::int64_t testClock() noexcept {
  return testTime();
}

TEST(GuardedBus, CallsAGuardianThatDoesNotCycleSilentAndItsReturnNotAndBlamesItForNoPauseOfItsOwn) {
  simulation::RobotImage image;
  GuardianLink link;
  const std::unique_ptr<AxisBus> cards = simulation::openImageCards(image);
  ASSERT_TRUE(cards->selfTest().passed);
  GuardedBus::Options options;
  options.clock = testClock;
  GuardedBus bus(*cards, link, 3, options);
  AxisFeedback feedback;
  testTime() = 1'000'000;
  const auto cycle = [&](std::int64_t ms, bool guardian_lives) {
    testTime() += ms * 1'000'000;
    if (guardian_lives) link.guardian_cycles.fetch_add(1);
    bus.read(feedback);
    return bus.failure().fault;
  };
  for (int k = 0; k < 200; ++k)
    ASSERT_EQ(cycle(1, true), BusFault::None);
  for (int k = 1; k < 50; ++k)
    ASSERT_EQ(cycle(1, false), BusFault::None) << k;
  EXPECT_EQ(cycle(1, false), BusFault::GuardianSilent);
  EXPECT_EQ(cycle(1, true), BusFault::None) << "it is back; the Supervisor keeps its fault";
  EXPECT_EQ(cycle(500, false), BusFault::None) << "this process stood still, and perhaps the guardian with it";
}

/// A bus with one thing to say of itself.
class ComplainingBus : public AxisBus {
 public:
  SelfTest selfTest() override { return {true, {}}; }
  IoStatus read(AxisFeedback&) noexcept override { return IoStatus::Ok; }
  IoStatus writeVolts(const std::array<double, kAxes>&, std::array<double, kAxes>&) noexcept override {
    return IoStatus::Ok;
  }
  IoStatus writeOutputs(std::uint8_t) noexcept override { return IoStatus::Ok; }
  BusFailure failure() const noexcept override { return complaint; }
  BusFailure complaint;
};

TEST(GuardedBus, SaysWhatIsWrongWithADriveBeforeThatTheGuardianIsSilent) {
  ComplainingBus drives;
  GuardianLink link;
  GuardedBus::Options options;
  options.clock = testClock;
  GuardedBus bus(drives, link, 3, options);
  AxisFeedback feedback;
  for (int k = 0; k < 60; ++k) {
    testTime() += 1'000'000;
    bus.read(feedback);
  }
  ASSERT_EQ(bus.failure().fault, BusFault::GuardianSilent);
  drives.complaint.silent = 4;
  EXPECT_EQ(bus.failure().silent, 4) << "its counts are old, whoever else is silent";
  drives.complaint.fault = BusFault::DriveFault;
  EXPECT_EQ(bus.failure().fault, BusFault::DriveFault) << "its loop is lost: no deceleration along the path";
}

/// What `SharedGuardianLink::open` says where /dev/shm is full: 0 as wanted, 1 nothing or something else, 2 cannot be
/// tried here.
int openWithoutRoom() {
  const bool own = ::unshare(CLONE_NEWNS) == 0 && ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                   ::mount("tmpfs", "/dev/shm", "tmpfs", 0, "size=4k") == 0;
  if (!own) return 2;
  const int full = ::open("/dev/shm/full", O_WRONLY | O_CREAT, 0600);
  const std::string page(4096, '.');
  if (::write(full, page.data(), page.size()) != static_cast<ssize_t>(page.size())) return 2;
  try {
    SharedGuardianLink::open("/knee_test_without_room");
  } catch (const InputError& error) {
    return std::string(error.what()).find("there is no room left in /dev/shm") != std::string::npos ? 0 : 1;
  }
  return 1;
}

TEST(SharedGuardianLink, SaysThatSharedMemoryIsFullInsteadOfDyingOfItLater) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) ::_exit(openWithoutRoom());
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  if (WEXITSTATUS(status) == 2) GTEST_SKIP() << "needs the right to mount in a namespace of its own";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace knee_robot::hardware
