#include "knee_robot/rt/task_context.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "knee_robot/rt/activity.h"

namespace knee_robot::rt {
namespace {

/// Writes down which hooks ran; throws or refuses where told.
class Probe : public TaskContext {
 public:
  Probe() : TaskContext("Probe") {}
  std::vector<std::string> calls;
  std::string throws_in, refuses_in, fatal_in, error_in;

  int count(const std::string& hook) const {
    int n = 0;
    for (const std::string& call : calls)
      n += call == hook ? 1 : 0;
    return n;
  }

 protected:
  bool enter(const std::string& hook) {
    calls.push_back(hook);
    if (throws_in.find(hook) != std::string::npos) throw std::runtime_error("thrown in " + hook);
    if (fatal_in == hook) fatal("fatal on purpose");
    if (error_in == hook) error();
    return refuses_in == hook ? refuse("refused on purpose") : true;
  }
  bool configureHook() override { return enter("configureHook"); }
  bool startHook() override { return enter("startHook"); }
  void updateHook(const Cycle&) override { enter("updateHook"); }
  void stopHook() override { enter("stopHook"); }
};

void runToRunning(Probe& probe) {
  ASSERT_TRUE(probe.configure());
  ASSERT_TRUE(probe.start());
}

TEST(TaskContext, WalksTheOrdinaryRoadThroughAllStates) {
  Probe probe;
  EXPECT_EQ(probe.state(), TaskState::PreOperational);
  EXPECT_FALSE(probe.start()) << "not configured yet";
  runToRunning(probe);
  EXPECT_EQ(probe.state(), TaskState::Running);
  probe.update({});
  EXPECT_FALSE(probe.configure()) << "still running";
  EXPECT_TRUE(probe.stop());
  probe.update({});
  EXPECT_EQ(probe.state(), TaskState::Stopped);
  const std::vector<std::string> expected = {"configureHook", "startHook", "updateHook", "stopHook"};
  EXPECT_EQ(probe.calls, expected);
}

TEST(TaskContext, StaysWhereItIsWhenAHookRefuses) {
  Probe probe;
  probe.refuses_in = "configureHook";
  EXPECT_FALSE(probe.configure());
  EXPECT_EQ(probe.state(), TaskState::PreOperational);
  EXPECT_STREQ(probe.refusal(), "refused on purpose");
  probe.refuses_in = "startHook";
  EXPECT_TRUE(probe.configure());
  EXPECT_FALSE(probe.start());
  EXPECT_EQ(probe.state(), TaskState::Stopped);
}

TEST(TaskContext, RunsStopHookOnceAfterAnExceptionInAnyHookOfAComponentThatRuns) {
  for (const std::string hook : {"startHook", "updateHook", "stopHook", "configureHook"}) {
    SCOPED_TRACE(hook);
    Probe probe;
    probe.throws_in = hook;
    if (probe.configure() && probe.start()) {
      probe.update({});
      probe.update({});
      probe.stop();
    }
    EXPECT_EQ(probe.state(), TaskState::Exception);
    const bool ever_started = hook != "configureHook";
    EXPECT_EQ(probe.count("stopHook"), ever_started ? 1 : 0);
    EXPECT_EQ(probe.calls.back(), ever_started ? "stopHook" : "configureHook");
    EXPECT_EQ(std::string(probe.refusal()), "thrown in " + hook);
    EXPECT_TRUE(probe.recover());
    EXPECT_EQ(probe.state(), TaskState::PreOperational);
  }
}

TEST(TaskContext, IsBeyondRepairWhenStopHookThrowsOnTheWayToo) {
  Probe probe;
  probe.throws_in = "updateHook stopHook";
  runToRunning(probe);
  probe.update({});
  const std::vector<std::string> expected = {"configureHook", "startHook", "updateHook", "stopHook"};
  EXPECT_EQ(probe.calls, expected);
  EXPECT_EQ(probe.state(), TaskState::FatalError);
  EXPECT_STREQ(probe.refusal(), "thrown in updateHook") << "the first cause is the one that is told";
}

TEST(TaskContext, RunsStopHookOnTheFatalRoadToo) {
  Probe probe;
  probe.fatal_in = "updateHook";
  runToRunning(probe);
  probe.update({});
  probe.update({});
  EXPECT_EQ(probe.count("stopHook"), 1);
  EXPECT_EQ(probe.count("updateHook"), 1);
  EXPECT_EQ(probe.state(), TaskState::FatalError);
  EXPECT_FALSE(probe.recover());
  EXPECT_FALSE(probe.start());
}

TEST(TaskContext, CallsNoHookAfterAnErrorOfItsOwnUntilRecoveredButStopHook) {
  Probe probe;
  probe.error_in = "updateHook";
  runToRunning(probe);
  probe.update({});
  EXPECT_EQ(probe.state(), TaskState::RunTimeError);
  probe.update({});
  EXPECT_EQ(probe.count("updateHook"), 1);
  probe.error_in.clear();
  EXPECT_TRUE(probe.recover());
  probe.update({});
  EXPECT_EQ(probe.count("updateHook"), 2);
  probe.error_in = "updateHook";
  probe.update({});
  EXPECT_EQ(probe.state(), TaskState::RunTimeError);
  EXPECT_TRUE(probe.stop());
  EXPECT_EQ(probe.count("stopHook"), 1);
}

/// Remembers in which thread its hooks ran.
class ThreadProbe : public TaskContext {
 public:
  ThreadProbe() : TaskContext("ThreadProbe") {}
  std::thread::id started_in, stopped_in;
  std::atomic<int> updates{0};

 protected:
  bool startHook() override {
    started_in = std::this_thread::get_id();
    return true;
  }
  void updateHook(const Cycle&) override { updates.fetch_add(1); }
  void stopHook() override { stopped_in = std::this_thread::get_id(); }
};

TEST(TaskContext, ExecutesCommandsOfOtherThreadsInItsActivity) {
  ThreadProbe probe;
  ActivityOptions options;
  options.period = 500'000;
  PeriodicActivity activity(options);
  activity.add(probe);
  ASSERT_TRUE(probe.configure());
  activity.start(monotonicNow());
  ASSERT_TRUE(probe.start());
  while (probe.updates.load() < 3)
    std::this_thread::yield();
  ASSERT_TRUE(probe.stop());
  EXPECT_FALSE(probe.stop()) << "refused by the activity, too";
  activity.stop();
  EXPECT_NE(probe.started_in, std::this_thread::get_id());
  EXPECT_EQ(probe.started_in, probe.stopped_in);
}

TEST(CommandMailbox, WithdrawsACommandThatNobodyTook) {
  CommandMailbox mailbox;
  EXPECT_EQ(mailbox.call(Command::Start, 1'000'000), CommandMailbox::Answer::TimedOut);
  int executed = 0;
  mailbox.serve([&](Command) { return ++executed > 0; });
  EXPECT_EQ(executed, 0);
}

TEST(CommandMailbox, AnswersEveryCallerAmongMany) {
  CommandMailbox mailbox;
  std::atomic<int> open{4};
  std::atomic<int> accepted{0}, refused{0};
  std::vector<std::thread> callers;
  for (int i = 0; i < 4; ++i) {
    callers.emplace_back([&, i] {
      for (int k = 0; k < 20; ++k) {
        const auto answer = mailbox.call(i % 2 == 0 ? Command::Start : Command::Stop, 10 * kNanosecondsPerSecond);
        if (answer == CommandMailbox::Answer::Accepted) ++accepted;
        if (answer == CommandMailbox::Answer::Refused) ++refused;
      }
      --open;
    });
  }
  int served = 0;
  while (open.load() > 0)
    mailbox.serve([&](Command command) { return ++served, command == Command::Start; });
  for (std::thread& caller : callers)
    caller.join();
  EXPECT_EQ(served, 80);
  EXPECT_EQ(accepted.load(), 40);
  EXPECT_EQ(refused.load(), 40);
}

}  // namespace
}  // namespace knee_robot::rt
