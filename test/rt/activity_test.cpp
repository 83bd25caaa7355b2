#include "knee_robot/rt/activity.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "knee_robot/base/errors.h"
#include "knee_robot/rt/stepped_activity.h"

namespace knee_robot::rt {
namespace {

/// Notes its cycles.
class Counter : public TaskContext {
 public:
  explicit Counter(std::string name, std::vector<std::string>* log = nullptr)
      : TaskContext(std::move(name)), log_(log) {
    times.reserve(10'000);
  }
  std::vector<Nanoseconds> times;
  std::atomic<int> updates{0};
  std::atomic<int> hang_ms{0};
  Nanoseconds period = 0;

 protected:
  void updateHook(const Cycle& cycle) override {
    if (times.size() < times.capacity()) times.push_back(cycle.time);
    period = cycle.period;
    if (log_ != nullptr) log_->push_back(name());
    const int hang = hang_ms.load();
    if (hang > 0) std::this_thread::sleep_for(std::chrono::milliseconds(hang));
    ++updates;
  }

 private:
  std::vector<std::string>* log_;
};

ActivityOptions everyMillisecond() {
  return {};
}

void makeRun(TaskContext& component) {
  ASSERT_TRUE(component.configure());
  ASSERT_TRUE(component.start());
}

TEST(SteppedActivity, ExecutesComponentsInOrderAndSlowerOnesEverySoManyCycles) {
  std::vector<std::string> log;
  Counter fast("fast", &log), slow("slow", &log), last("last", &log);
  SteppedActivity activity(everyMillisecond());
  activity.add(slow, 3'000'000);
  activity.add(fast);
  activity.add(last);
  for (Counter* one : {&slow, &fast, &last})
    makeRun(*one);
  activity.start(0);
  for (int i = 0; i < 4; ++i)
    activity.step();
  const std::vector<std::string> expected = {"slow", "fast", "last", "fast", "last",
                                             "fast", "last", "slow", "fast", "last"};
  EXPECT_EQ(log, expected);
  EXPECT_EQ(slow.times, (std::vector<Nanoseconds>{0, 3'000'000}));
  EXPECT_EQ(slow.period, 3'000'000);
  EXPECT_EQ(fast.period, 1'000'000);
}

TEST(SteppedActivity, RunsAComponentOnceAfterAPauseAndKeepsItsSpacing) {
  Counter slow("slow");
  SteppedActivity activity(everyMillisecond());
  activity.add(slow, 10'000'000);
  makeRun(slow);
  activity.start(0);
  for (int i = 0; i < 8; ++i)
    activity.step();
  activity.skip(25);
  for (int i = 0; i < 15; ++i)
    activity.step();
  EXPECT_EQ(slow.times, (std::vector<Nanoseconds>{0, 33'000'000, 43'000'000}));
  EXPECT_EQ(activity.statistics().missed.load(), 25u);
  EXPECT_EQ(activity.statistics().overruns.load(), 1u);
}

TEST(SteppedActivity, InterleavesActivitiesByTime) {
  std::vector<std::string> log;
  Counter a("a", &log), b("b", &log);
  ActivityOptions slow;
  slow.period = 2'000'000;
  SteppedActivity first(slow), second(everyMillisecond());
  first.add(a);
  second.add(b);
  makeRun(a);
  makeRun(b);
  first.start(0);
  second.start(0);
  for (int i = 0; i < 6; ++i)
    stepEarliest({&first, &second});
  EXPECT_EQ(log, (std::vector<std::string>{"a", "b", "b", "a", "b", "b"}));
}

TEST(Activity, RefusesAPeriodThatIsNoWholeMultiple) {
  Counter counter("counter");
  SteppedActivity activity(everyMillisecond());
  EXPECT_THROW(activity.add(counter, 1'500'000), InputError);
  EXPECT_THROW(activity.add(counter, 500'000), InputError);
}

TEST(PeriodicActivity, KeepsToTheGridOfItsPeriod) {
  Counter counter("counter");
  PeriodicActivity activity(everyMillisecond());
  activity.add(counter);
  makeRun(counter);
  activity.start(monotonicNow());
  while (counter.updates.load() < 50)
    std::this_thread::yield();
  activity.stop();
  for (std::size_t i = 0; i < counter.times.size(); ++i) {
    EXPECT_EQ(counter.times[i] % 1'000'000, 0);
    if (i > 0) {
      EXPECT_GT(counter.times[i], counter.times[i - 1]);
    }
  }
  const auto execution = activity.statistics().execution.snapshot();
  EXPECT_EQ(execution.count, activity.statistics().cycles.load());
}

TEST(PeriodicActivity, SkipsAndCountsMissedCyclesInsteadOfABurst) {
  Counter counter("counter");
  PeriodicActivity activity(everyMillisecond());
  activity.add(counter);
  makeRun(counter);
  counter.hang_ms = 5;
  activity.start(monotonicNow());
  while (counter.updates.load() < 10)
    std::this_thread::yield();
  activity.stop();
  for (std::size_t i = 1; i < counter.times.size(); ++i) {
    EXPECT_GE(counter.times[i] - counter.times[i - 1], 5'000'000) << "a catch-up cycle";
  }
  const auto cycles = activity.statistics().cycles.load();
  EXPECT_GE(activity.statistics().missed.load(), 4 * (cycles - 1));
}

TEST(PeriodicActivity, CallsTheHandlerOnceWhenOverrunsFollowOneAnother) {
  Counter counter("counter");
  ActivityOptions options;
  options.overrun_limit = 3;
  PeriodicActivity activity(options);
  activity.add(counter);
  std::atomic<int> called{0};
  activity.setOverrunHandler([&] { ++called; });
  makeRun(counter);
  counter.hang_ms = 3;
  activity.start(monotonicNow());
  while (counter.updates.load() < 8)
    std::this_thread::yield();
  activity.stop();
  EXPECT_EQ(called.load(), 1);
}

TEST(PeriodicActivity, RefusesToStartWithoutThePrivilegesThatAreRequired) {
  Counter counter("counter");
  ActivityOptions options;
  options.cpu = 1000;  // does not exist anywhere
  PeriodicActivity lenient(options);
  lenient.add(counter);
  EXPECT_EQ(lenient.start(monotonicNow()).size(), 1u) << "says what it did not get";
  lenient.stop();
  options.require_real_time = true;
  PeriodicActivity strict(options);
  EXPECT_THROW(strict.start(monotonicNow()), InputError);
  EXPECT_FALSE(strict.isActive());
}

TEST(DurationHistogram, PutsDurationsIntoBucketsOfPowersOfTwo) {
  DurationHistogram histogram;
  for (const Nanoseconds value : {0, 1, 2, 3, 1024, 2047})
    histogram.add(value);
  const auto snapshot = histogram.snapshot();
  EXPECT_EQ(snapshot.count, 6u);
  EXPECT_EQ(snapshot.max, 2047);
  EXPECT_EQ(snapshot.buckets[0], 2u);
  EXPECT_EQ(snapshot.buckets[1], 2u);
  EXPECT_EQ(snapshot.buckets[10], 2u);
  EXPECT_EQ(snapshot.quantile(0.5), 4);
  EXPECT_EQ(snapshot.quantile(1.0), 2047);
}

}  // namespace
}  // namespace knee_robot::rt
