#include "knee_robot/control/guardian.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

#include "knee_robot/hardware/guarded_bus.h"
#include "knee_robot/simulation/simulated_cards.h"

namespace knee_robot::control {
namespace {

using hardware::IoStatus;

constexpr rt::Nanoseconds kMs = 1'000'000;

rt::Nanoseconds& testTime() {
  static rt::Nanoseconds time = 0;
  return time;
}
rt::Nanoseconds testClock() noexcept {
  return testTime();
}

/// A watch with a limit of 10 ms, stepped once a millisecond.
struct Watched {
  GuardianWatch watch{10 * kMs, kMs};
  GuardianView view;
  GuardianAction step(bool beats, rt::Nanoseconds elapsed = kMs) {
    view.now += elapsed;
    if (beats) ++view.heartbeat;
    return watch.step(view);
  }
};

TEST(GuardianWatch, LeavesAControllerAloneThatBeats) {
  Watched w;
  w.view.armed = true;
  for (int i = 0; i < 1000; ++i)
    ASSERT_EQ(w.step(i % 9 == 0), GuardianAction::Watch) << i;
}

TEST(GuardianWatch, TripsAfterTheLimitOfSilenceOnceAndKeepsDown) {
  Watched w;
  w.view.armed = true;
  w.step(true);
  for (int i = 1; i < 10; ++i)
    ASSERT_EQ(w.step(false), GuardianAction::Watch) << i;
  EXPECT_EQ(w.step(false), GuardianAction::Trip);
  EXPECT_EQ(w.watch.cause(), GuardianCause::Silent);
  EXPECT_EQ(w.step(false), GuardianAction::KeepDown);
  EXPECT_EQ(w.step(true), GuardianAction::KeepDown) << "coming back does not help";
}

TEST(GuardianWatch, TripsAtOnceWhenTheProcessIsGone) {
  Watched w;
  w.view.armed = true;
  w.step(true);
  w.view.process_gone = true;
  EXPECT_EQ(w.step(true), GuardianAction::Trip);
  EXPECT_EQ(w.watch.cause(), GuardianCause::ProcessGone);
}

TEST(GuardianWatch, KeepsDownWhatSomebodyElseHasBroughtDown) {
  Watched w;
  w.view.armed = true;
  ASSERT_EQ(w.step(true), GuardianAction::Watch);
  w.view.fenced = true;
  EXPECT_EQ(w.step(true), GuardianAction::KeepDown);
  w.view.armed = false;
  w.view.reset_asked = true;
  EXPECT_EQ(w.step(true), GuardianAction::Release);
}

TEST(GuardianWatch, MindsNeitherSilenceNorAnEndWithTheDrivesOff) {
  Watched w;
  w.step(true);
  w.view.process_gone = true;
  for (int i = 0; i < 1000; ++i)
    ASSERT_EQ(w.step(false), GuardianAction::Watch);
  w.view.process_gone = false;
  w.view.armed = true;
  EXPECT_EQ(w.step(true), GuardianAction::Watch) << "silence before arming does not count";
}

TEST(GuardianWatch, DoesNotBlameTheControllerForAPauseOfTheWholeMachine) {
  Watched w;
  w.view.armed = true;
  w.step(true);
  EXPECT_EQ(w.step(false, 200 * kMs), GuardianAction::Watch);
  EXPECT_EQ(w.step(true), GuardianAction::Watch);
  w.step(false, 200 * kMs);
  int cycles = 0;
  while (w.step(false) == GuardianAction::Watch)
    ++cycles;
  EXPECT_LT(cycles, 10) << "but the pause does not buy more than the limit";
}

TEST(GuardianWatch, ReleasesOnlyWhenAskedWithTheDrivesOff) {
  Watched w;
  w.view.armed = true;
  w.view.process_gone = true;
  ASSERT_EQ(w.step(true), GuardianAction::Trip);
  w.view.process_gone = false;
  w.view.reset_asked = true;
  EXPECT_EQ(w.step(true), GuardianAction::KeepDown) << "drives are still wanted";
  w.view.armed = false;
  w.view.reset_asked = false;
  EXPECT_EQ(w.step(true), GuardianAction::KeepDown) << "nobody asks";
  w.view.reset_asked = true;
  EXPECT_EQ(w.step(true), GuardianAction::Release);
  w.view.reset_asked = false;
  w.view.armed = true;
  EXPECT_EQ(w.step(true), GuardianAction::Watch);
}

/// Guardian and guarded controller on one pair of card models; no thread, the test's clock.
class GuardedCards : public ::testing::Test {
 protected:
  GuardedCards() {
    testTime() = 0;
    guardian_.configure();
    guardian_.start();
    // What selfTest() does, without waiting for a guardian that runs beside it.
    link_.controller_pid.store(::getpid());
    EXPECT_TRUE(cards_->selfTest().passed);
  }
  void cycle() {
    testTime() += kMs;
    guardian_.update({testTime(), testTime(), kMs});
  }
  IoStatus hold(double volts = 3.0) {
    hardware::IoStatus status = bus_.writeVolts({volts, volts, volts, volts}, written_);
    heartbeat_ ^= 4;
    const IoStatus outputs = bus_.writeOutputs(heartbeat_ | 3);  // drives enabled, hold devices released
    return status == IoStatus::Ok ? outputs : status;
  }
  double volts(std::size_t channel) const { return simulation::outputVolts(image_.analog)[channel]; }

  simulation::RobotImage image_;
  hardware::GuardianLink link_;
  std::unique_ptr<hardware::AxisBus> cards_ = simulation::openImageCards(image_);
  std::unique_ptr<hardware::EmergencyOutputs> outputs_ = simulation::openImageEmergencyOutputs(image_);
  hardware::GuardedBus bus_{*cards_, link_, 3};
  Guardian guardian_{link_, *outputs_, 10 * kMs, kMs, testClock};
  std::array<double, hardware::kAxes> written_{};
  std::uint8_t heartbeat_ = 0;
};

TEST_F(GuardedCards, AreNeverWrittenByTheGuardianWhileTheControllerIsHealthy) {
  for (int i = 0; i < 500; ++i) {
    ASSERT_EQ(hold(), IoStatus::Ok);
    const std::uint64_t updates = image_.analog.updates.load();
    const std::uint8_t outputs = image_.counter.outputs.load();
    cycle();
    ASSERT_EQ(image_.analog.updates.load(), updates);
    ASSERT_EQ(image_.counter.outputs.load(), outputs);
    ASSERT_EQ(outputs & 3, 3);
  }
  EXPECT_EQ(guardian_.report().trips.load(), 0u);
}

TEST_F(GuardedCards, AreGivenBackToEachOfTwoWhoAskAtOnce) {
  link_.tripped.store(1);
  std::thread other([this] {
    while (link_.reset_request.load() == 0)
      std::this_thread::yield();
    const std::uint32_t newest = link_.reset_request.fetch_add(1) + 1;
    link_.tripped.store(0);
    link_.reset_done.store(newest);  // the guardian has seen both, and answers the newest
  });
  EXPECT_EQ(bus_.reclaim(), IoStatus::Ok);
  other.join();
}

TEST_F(GuardedCards, AreBroughtDownWhenTheControllerFallsSilent) {
  hold();
  cycle();
  EXPECT_GT(volts(0), 2.9);
  for (int i = 0; i < 10; ++i)
    cycle();
  EXPECT_EQ(guardian_.report().trips.load(), 1u);
  EXPECT_EQ(guardian_.report().reaction.load(), 10 * kMs);
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  for (std::size_t channel = 0; channel < hardware::kAxes; ++channel)
    EXPECT_EQ(volts(channel), 0.0);
}

/// The same with a guardian that lets the drives carry for 30 ms.
class CarriedCards : public GuardedCards {
 protected:
  CarriedCards() {
    carrying_.configure();
    carrying_.start();
  }
  void cycleCarrying(int cycles = 1) {
    for (int i = 0; i < cycles; ++i) {
      testTime() += kMs;
      carrying_.update({testTime(), testTime(), kMs});
    }
  }
  void dies(double load_V) {
    hold(9.0);
    const std::array<double, hardware::kAxes> load = {load_V, -load_V, 0.5, 1.0};
    bus_.offerLoad(&load);
    cycleCarrying();
    hold(9.0);  // the guardian has to see it alive
    cycleCarrying(11);
  }
  Guardian carrying_{link_, *outputs_, 10 * kMs, kMs, testClock, {1, 4, 30 * kMs}};
};

TEST_F(CarriedCards, AreCarriedByWhatCarriedThemAtRestUntilTheBrakesHold) {
  dies(2.0);
  EXPECT_EQ(carrying_.report().trips.load(), 1u);
  EXPECT_EQ(image_.counter.outputs.load() & 3, 1) << "drives on, hold devices ordered to engage";
  EXPECT_NEAR(volts(0), 2.0, 0.005);
  EXPECT_NEAR(volts(1), -2.0, 0.005);
  cycleCarrying(29);
  EXPECT_NEAR(volts(0), 2.0, 0.005);
  cycleCarrying(2);
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  for (std::size_t channel = 0; channel < hardware::kAxes; ++channel)
    EXPECT_EQ(volts(channel), 0.0);
}

TEST_F(CarriedCards, KeepAHeartbeatForTheRelayThatWouldTakeTheDrivesPower) {
  dies(2.0);
  for (int i = 0; i < 29; ++i) {
    const unsigned before = image_.counter.outputs.load();
    cycleCarrying();
    EXPECT_NE((before ^ image_.counter.outputs.load()) & 4u, 0u) << i;
  }
  cycleCarrying(2);
  EXPECT_EQ(image_.counter.outputs.load(), 0);
}

TEST_F(CarriedCards, HaveAGuardianThatSaysThatItActsUntilTheyAreDown) {
  EXPECT_FALSE(carrying_.report().acts.load());
  dies(2.0);
  EXPECT_TRUE(carrying_.report().acts.load()) << "ended now, it would leave the drives on";
  cycleCarrying(29);
  EXPECT_TRUE(carrying_.report().acts.load());
  cycleCarrying(2);
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  EXPECT_FALSE(carrying_.report().acts.load());
}

TEST_F(CarriedCards, AWriteThatWasUnderWayIsTakenBackWhileTheyAreCarried) {
  dies(2.0);
  cards_->writeVolts({9, 9, 9, 9}, written_);
  cards_->writeOutputs(3);
  cycleCarrying();
  EXPECT_EQ(image_.counter.outputs.load() & 3, 1);
  EXPECT_NEAR(volts(0), 2.0, 0.005);
}

TEST_F(CarriedCards, GoDownAtOnceWithoutALoadThatIsANumber) {
  dies(std::nan(""));
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  EXPECT_EQ(volts(0), 0.0);
}

TEST_F(CarriedCards, GoDownAtOnceWithALoadThatNoControllerCanHaveGiven) {
  dies(1e6);  // somebody has written over the link
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  EXPECT_EQ(volts(0), 0.0);
}

TEST_F(CarriedCards, GoDownAtOnceWhereNothingIsCarried) {
  hold(9.0);
  cycleCarrying();
  hold(9.0);
  bus_.offerLoad(nullptr);
  cycleCarrying(11);
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  EXPECT_EQ(volts(0), 0.0);
}

TEST_F(CarriedCards, AreNeverSwitchedOnByAGuardianThatStartsAndFindsADeadControllersLoad) {
  hold(9.0);
  const std::array<double, hardware::kAxes> load = {2.0, 2.0, 2.0, 2.0};
  bus_.offerLoad(&load);
  cards_->writeOutputs(0);                 // somebody has switched it off since
  link_.controller_pid.store(2147483646);  // no such process
  Guardian second(link_, *outputs_, 10 * kMs, kMs, testClock, {1, 4, 30 * kMs});
  second.configure();
  second.start();
  for (int i = 0; i < 60; ++i) {
    testTime() += kMs;
    second.update({testTime(), testTime(), kMs});
    ASSERT_EQ(image_.counter.outputs.load(), 0) << "cycle " << i;
    ASSERT_EQ(volts(0), 0.0) << "cycle " << i;
  }
  EXPECT_EQ(second.report().trips.load(), 1u);
}

TEST_F(CarriedCards, AreDownBeforeTheyAreGivenBack) {
  dies(2.0);
  bus_.writeOutputs(0);
  link_.reset_request.fetch_add(1);
  cycleCarrying();
  EXPECT_FALSE(bus_.isFencedOut());
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  EXPECT_EQ(volts(0), 0.0);
}

TEST_F(GuardedCards, RefuseAControllerThatComesBackUntilItAsksWithItsDrivesOff) {
  hold();
  for (int i = 0; i < 12; ++i)
    cycle();
  ASSERT_TRUE(bus_.isFencedOut());
  EXPECT_EQ(hold(), IoStatus::FencedOut);
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  // The one write that was under way when the process was stopped: taken back in the next cycle.
  cards_->writeVolts({5, 5, 5, 5}, written_);
  cards_->writeOutputs(3);
  cycle();
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  EXPECT_EQ(volts(2), 0.0);

  link_.reset_request.fetch_add(1);
  cycle();
  EXPECT_TRUE(bus_.isFencedOut()) << "it still wants its drives";
  EXPECT_EQ(bus_.writeOutputs(0), IoStatus::FencedOut);
  cycle();
  EXPECT_FALSE(bus_.isFencedOut());
  EXPECT_EQ(bus_.writeOutputs(4), IoStatus::Ok);
}

TEST_F(GuardedCards, StayDownUnderAGuardianThatIsStartedAnew) {
  hold();
  for (int i = 0; i < 12; ++i)
    cycle();
  Guardian second(link_, *outputs_, 10 * kMs, kMs, testClock);
  second.configure();
  second.start();
  cards_->writeOutputs(3);
  second.update({testTime(), testTime(), kMs});
  EXPECT_EQ(image_.counter.outputs.load(), 0);
}

TEST_F(GuardedCards, AreBroughtDownByAGuardianThatStartsAndFindsNobodyInCharge) {
  hold();
  link_.armed.store(0);  // a refused controller has been there, or the link's memory is new
  link_.controller_pid.store(0);
  Guardian second(link_, *outputs_, 10 * kMs, kMs, testClock);
  second.configure();
  second.start();
  second.update({testTime(), testTime(), kMs});
  EXPECT_TRUE(second.report().found_nobody.load());
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  EXPECT_EQ(volts(0), 0.0);
}

TEST_F(GuardedCards, AreLeftToALiveControllerByAGuardianThatStarts) {
  hold();
  Guardian second(link_, *outputs_, 10 * kMs, kMs, testClock);
  second.configure();
  second.start();
  second.update({testTime(), testTime(), kMs});
  EXPECT_FALSE(second.report().found_nobody.load());
  EXPECT_EQ(image_.counter.outputs.load() & 3, 3);
}

TEST_F(GuardedCards, MayBeLeftWithTheDrivesOff) {
  hold();
  cycle();
  EXPECT_EQ(bus_.writeOutputs(0), IoStatus::Ok);
  for (int i = 0; i < 100; ++i)
    cycle();
  EXPECT_EQ(guardian_.report().trips.load(), 0u);
}

TEST_F(GuardedCards, AreBroughtDownInOneCycleWhenTheProcessDiesEvenAsAZombie) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::pause();
    ::_exit(0);
  }
  link_.controller_pid.store(child);
  hold();
  cycle();
  ASSERT_EQ(guardian_.report().trips.load(), 0u);
  ::kill(child, SIGKILL);
  siginfo_t ended{};
  ::waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT);  // dead, and not reaped
  EXPECT_TRUE(hardware::processExists(child)) << "kill(pid, 0) does not see it";
  hold();  // the heartbeat itself is fresh
  cycle();
  EXPECT_EQ(guardian_.report().trips.load(), 1u);
  EXPECT_EQ(guardian_.report().cause.load(), GuardianCause::ProcessGone);
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  ::waitpid(child, nullptr, 0);
}

TEST_F(GuardedCards, AreLeftAsTheyAreWhenOneOfThemIsLostButTheOtherIsStillBroughtDown) {
  hold();
  cycle();
  image_.counter.disconnected.store(1);
  for (int i = 0; i < 12; ++i)
    cycle();
  EXPECT_FALSE(guardian_.report().written.load());
  EXPECT_EQ(volts(0), 0.0);
}

}  // namespace
}  // namespace knee_robot::control
