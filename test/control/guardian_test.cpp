#include "knee_robot/control/guardian.h"

#include <sys/wait.h>

#include <thread>

#include "guarded_cards.h"

namespace knee_robot::control {
namespace {

using namespace guarded;

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

TEST(GuardianWatch, TakesOverFromAControllerThatSomebodyElseHasLockedOut) {
  Watched w;
  w.view.armed = true;
  ASSERT_EQ(w.step(true), GuardianAction::Watch);
  w.view.fenced = true;
  EXPECT_EQ(w.step(true), GuardianAction::Trip) << "what it carried is handed over";
  EXPECT_EQ(w.watch.cause(), GuardianCause::LockedOut);
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

TEST_F(GuardedCards, AreNotTouchedByAGuardianInWhosePlaceAnotherOneHasActed) {
  hold();
  cycle();
  const std::uint64_t cycles = link_.guardian_cycles.load();
  link_.guardian_pid.store(0);  // its heir, which has ended since
  link_.tripped.store(1);
  for (int i = 0; i < 12; ++i)
    cycle();
  EXPECT_TRUE(guardian_.isReplaced());
  EXPECT_NEAR(volts(0), 3.0, 0.01);
  EXPECT_EQ(guardian_.report().trips.load(), 0u);
  EXPECT_EQ(link_.guardian_cycles.load(), cycles) << "whoever listens to it hears nobody";
}

}  // namespace
}  // namespace knee_robot::control
