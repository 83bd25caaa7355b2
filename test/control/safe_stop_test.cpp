#include "src/control/safe_stop.h"

#include <gtest/gtest.h>

#include <vector>

#include "test/control/milliseconds.h"

namespace knee_robot::control {
namespace {

using Phase = SafeStopPhase;

SafeStopTiming timing() {
  SafeStopTiming timing;
  timing.decelerate_limit = 100 * kMs;
  timing.settle = 10 * kMs;
  timing.hold_delay = 30 * kMs;
  timing.disable_delay = 20 * kMs;
  return timing;
}

/// Phases in their order and how long each lasted (ms), stepped every ms for 300 ms. `rest_ms`: when the reference
/// comes to rest; `loops_ms`: when a loop fails.
struct Course {
  std::vector<Phase> phases;
  std::vector<int> lasted_ms;
};
Course course(bool released, int rest_ms, int loops_ms, bool immediate = false) {
  SafeStop stop(timing());
  stop.trigger(0, released);
  Course result;
  for (int ms = 1; ms <= 300; ++ms) {
    if (result.phases.empty() || result.phases.back() != stop.phase()) {
      result.phases.push_back(stop.phase());
      result.lasted_ms.push_back(0);
    }
    ++result.lasted_ms.back();
    stop.trigger(ms * kMs, released);  // again and again: no effect
    stop.step(ms * kMs, ms < loops_ms, ms >= rest_ms, immediate);
  }
  EXPECT_EQ(stop.completed(), 1u);
  return result;
}

TEST(SafeStop, DeceleratesSettlesEngagesDisablesAndOnlyThenGoesToZero) {
  const Course all = course(true, 50, 1000);
  EXPECT_EQ(all.phases,
            (std::vector<Phase>{Phase::Decelerating, Phase::Settling, Phase::Engaging, Phase::Disabling, Phase::Done}));
  EXPECT_EQ(all.lasted_ms[0], 50);
  EXPECT_EQ(all.lasted_ms[1], 10);
  EXPECT_EQ(all.lasted_ms[2], 30);
  EXPECT_EQ(all.lasted_ms[3], 20);
}

TEST(SafeStop, DoesNotWaitForeverForRest) {
  EXPECT_EQ(course(true, 1000, 1000).lasted_ms[0], 100);
}

TEST(SafeStop, SkipsToEngagingWhenALoopFails) {
  const std::vector<Phase> expected = {Phase::Decelerating, Phase::Engaging, Phase::Disabling, Phase::Done};
  EXPECT_EQ(course(true, 50, 0).phases, expected);
  EXPECT_EQ(course(true, 50, 0).lasted_ms[0], 1);
  EXPECT_EQ(course(true, 50, 1000, true).phases, expected) << "drive power is gone";
  const Course later = course(true, 50, 53);
  EXPECT_EQ(later.lasted_ms[1], 3) << "fails while settling";
}

TEST(SafeStop, DisablesAtOnceWhenTheHoldDevicesAreStillEngaged) {
  EXPECT_EQ(course(false, 0, 1000).phases, (std::vector<Phase>{Phase::Disabling, Phase::Done}));
}

/// A safe stop that hands the load over in 20 ms and watches for 10 ms more; stepped every ms up to `ms`.
struct Transfer {
  Transfer() : stop(with()) { stop.trigger(0, true); }
  static SafeStopTiming with() {
    SafeStopTiming all = timing();
    all.transfer = 20 * kMs;
    all.watch = 10 * kMs;
    return all;
  }
  void run(int ms, const HoldView& hold = {}, bool loops = true) {
    for (int end = now + ms; now < end;)
      stop.step(++now * kMs, loops, true, false, hold);
  }
  SafeStop stop;
  int now = 0;
};

TEST(SafeStop, TakesTheForceDownSlowlyBeforeTheDrivesGoOff) {
  Transfer t;
  t.run(42);  // at rest, settled, engaged
  ASSERT_EQ(t.stop.phase(), Phase::Transferring);
  t.run(10);
  EXPECT_NEAR(t.stop.share(), 0.5, 0.06);
  t.run(12);
  EXPECT_EQ(t.stop.share(), 0.0);
  EXPECT_EQ(t.stop.phase(), Phase::Transferring) << "still watched";
  t.run(10);
  EXPECT_EQ(t.stop.phase(), Phase::Disabling);
  t.run(30);
  EXPECT_EQ(t.stop.phase(), Phase::Done);
  t.stop.rearm();
  EXPECT_EQ(t.stop.share(), 1.0) << "whoever enables again is carried";
}

TEST(SafeStop, TakesTheLoadBackWhenAnAxisMovesAndKeepsItUntilItIsAskedAgain) {
  Transfer t;
  t.run(52);
  HoldView slips;
  slips.slipped = true;
  t.run(1, slips);
  EXPECT_EQ(t.stop.phase(), Phase::Carrying);
  EXPECT_EQ(t.stop.share(), 1.0);
  t.run(10000);
  EXPECT_EQ(t.stop.phase(), Phase::Carrying);
  HoldView again;
  again.again = 1;
  t.run(100, again);
  EXPECT_EQ(t.stop.phase(), Phase::Done) << "somebody has put a support under it";
  Transfer power;
  power.run(52);
  power.run(1, slips);
  power.run(100, {}, false);
  EXPECT_EQ(power.stop.phase(), Phase::Carrying) << "the brakes do not hold: a load estimate is better than nothing";
  power.run(2, again, false);
  power.run(1, {true, true, 1}, false);
  EXPECT_EQ(power.stop.phase(), Phase::Carrying) << "asked by nobody who has put a support under it: it slips again";
  power.run(100, {true, false, 2}, false);
  EXPECT_EQ(power.stop.phase(), Phase::Done) << "somebody has put a support under it";
  Transfer gone;
  gone.run(52);
  gone.run(1, slips);
  gone.stop.step(++gone.now * kMs, true, true, true, {});
  EXPECT_EQ(gone.stop.phase(), Phase::Disabling) << "the emergency stop has cut the power";
}

TEST(SafeStop, WatchesLongerAsLongAsAnAxisCreepsAndNotForEver) {
  HoldView creeps;
  creeps.creeps = true;
  Transfer t;
  t.run(400, creeps);
  EXPECT_EQ(t.stop.phase(), Phase::Transferring);
  creeps.slipped = true;
  t.run(1, creeps);
  EXPECT_EQ(t.stop.phase(), Phase::Carrying);
  Transfer slow;
  creeps.slipped = false;
  slow.run(700, creeps);
  EXPECT_EQ(slow.stop.phase(), Phase::Done) << "who has not moved by the slip until then does not in time";
}

TEST(SafeStop, WatchesTheHandOverWithTheLoopsThatAreLeftAsWell) {
  HoldView some;
  some.watched = true;
  Transfer t;
  t.run(32, some, false);
  EXPECT_EQ(t.stop.phase(), Phase::Transferring) << "no deceleration: 30 ms for the brakes";
  EXPECT_TRUE(t.stop.holdsHere());
  HoldView slips = some;
  slips.slipped = true;
  t.run(1, slips, false);
  EXPECT_EQ(t.stop.phase(), Phase::Carrying) << "a brake does not hold; once the drives went off all the same";
  HoldView runs = some;
  runs.runs = true;
  t.run(1, runs, false);
  EXPECT_EQ(t.stop.phase(), Phase::Disabling) << "what has no loop pushes harder than its brake holds";
  Transfer moving;
  some.stands = false;
  moving.run(70, some, false);
  EXPECT_EQ(moving.stop.phase(), Phase::Engaging) << "a brake that engaged in motion needs its time";
  moving.run(20, some, false);
  EXPECT_EQ(moving.stop.phase(), Phase::Transferring) << "not for ever";
  Transfer none;
  none.run(32, {}, false);
  EXPECT_EQ(none.stop.phase(), Phase::Disabling) << "no loop is left that could take anything back";
}

TEST(SafeStop, NeverGoesToZeroWhileTheHoldDevicesCannotBeOrdered) {
  Transfer t;
  HoldView orders_timed_out;
  orders_timed_out.ordered = false;
  t.run(10000, orders_timed_out, false);
  EXPECT_EQ(t.stop.phase(), Phase::Engaging);
  EXPECT_EQ(t.stop.share(), 1.0);
  t.run(100, {}, false);
  EXPECT_EQ(t.stop.phase(), Phase::Done);
}

TEST(SafeStop, RunsOnceUntilRearmed) {
  SafeStop stop(timing());
  EXPECT_FALSE(stop.isRunning());
  stop.trigger(0, false);
  for (int ms = 0; ms < 100; ++ms)
    stop.step(ms * kMs, true, true, false);
  stop.trigger(200 * kMs, true);
  EXPECT_EQ(stop.phase(), Phase::Done);
  stop.finishAtOnce();
  EXPECT_EQ(stop.completed(), 1u);
  stop.rearm();
  stop.finishAtOnce();
  EXPECT_EQ(stop.completed(), 2u);
  EXPECT_TRUE(stop.engagesHold());
  EXPECT_TRUE(stop.disablesDrive());
}

}  // namespace
}  // namespace knee_robot::control
