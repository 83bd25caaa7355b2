// The controller on real threads, with operators, recording and publishing beside it. Meant to be run under
// ThreadSanitizer too.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdio>
#include <thread>

#include "fake_machine.h"
#include "knee_robot/base/files.h"
#include "knee_robot/control/control_system.h"
#include "knee_robot/recording/recording.h"
#include "knee_robot/rt/activity.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

ControlSystem::Options nobodyOnIt() {
  ControlSystem::Options options;
  options.empty = true;
  return options;
}

using fake::kHome;

/// The fake machine moves on by one millisecond a cycle, however long the cycle took: what is tested here are threads,
/// and a loaded machine must not make the platform fall.
class LiveMachine : public fake::Machine {
 public:
  using fake::Machine::Machine;
  hardware::IoStatus read(hardware::AxisFeedback& feedback) noexcept override {
    advanceTo(time_s + 0.001);
    return fake::Machine::read(feedback);
  }
};

std::string deployment(const std::string& folder, bool sync_in_own_activity) {
  std::string text = readFile(std::string(KNEE_SOURCE_DIR) + "/config/deployment/simulation.yaml");
  const auto replace = [&](const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  };
  replace("priority: 80, overrun_limit: 20", "overrun_limit: 0");  // a loaded test machine is no fault here
  if (sync_in_own_activity) {
    replace("components:\n", "  - {name: slow, period_s: 0.01}\ncomponents:\n");
    replace("type: Sync, activity: servo, period_s: 0.01",
            "type: Sync, activity: slow, properties: {orders_timeout_s: 1.0}");
    for (const char* axis : {"{axis: 1", "{axis: 2", "{axis: 3", "{axis: 4"}) {
      replace(axis, std::string(axis) + ", stale_set_points: 100, missing_set_points: 100");
    }
  }
  const std::string path = folder + "/deployment.yaml";
  writeFileAtomically(path, text);
  return path;
}

void printTiming(ControlSystem& system) {
  const rt::ActivityStatistics& servo = system.deployment().activity("servo")->statistics();
  std::printf("servo cycle: median %.0f us, 99 %% %.0f us of processor or less; lateness 99 %% %.0f us\n",
              1e-3 * static_cast<double>(servo.execution.snapshot().quantile(0.5)),
              1e-3 * static_cast<double>(servo.execution.snapshot().quantile(0.99)),
              1e-3 * static_cast<double>(servo.lateness.snapshot().quantile(0.99)));
}

class Threads : public ::testing::TestWithParam<bool> {};

TEST_P(Threads, PlayWhileOperatorsAskRecordAndPublish) {
  const TemporaryFolder folder;
  const mechanism::Robot robot = fake::robot();
  LiveMachine machine(robot);
  ControlSystem::Options options;
  options.empty = true;
  ControlSystem system(robot, fake::hardware(), deployment(folder, GetParam()), machine, options);
  ASSERT_TRUE(system.start().ok);
  Answer answer = system.enable();
  ASSERT_TRUE(answer.ok) << answer.sentence;
  ASSERT_TRUE(system.startRecording(folder + "/r.csv").ok);
  ASSERT_TRUE(system.loadReference(fake::smoothReference(fake::kHome, 0.01, 1.0)).ok);

  std::atomic<bool> done{false};
  std::atomic<int> looks{0};
  std::thread publisher([&] {
    while (!done) {
      looks += system.snapshot().has_value() ? 1 : 0;
      (void)system.status();
      std::this_thread::yield();
    }
  });
  std::thread busybody([&] {
    while (!done) {
      EXPECT_FALSE(system.enable().ok) << system.status().fault_sentence;
      EXPECT_FALSE(system.resetFaults().ok);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
  EXPECT_TRUE(system.waitFor(MachineState::Holding, 5.0));
  std::this_thread::sleep_for(std::chrono::milliseconds(700));  // the platform settles after the brakes opened
  answer = system.play();
  EXPECT_TRUE(answer.ok) << answer.sentence;
  EXPECT_TRUE(system.waitFor(MachineState::Holding, 20.0)) << system.status().fault_sentence;
  // A machine that pauses makes set points late; what the reference then coasted too far fades out within
  // SetPointFollower::kBlend.
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  EXPECT_NEAR(system.snapshot()->reference_m[0], fake::kHome + 0.01, 1e-4);
  done = true;
  publisher.join();
  busybody.join();
  answer = system.disable();
  EXPECT_TRUE(answer.ok) << answer.sentence;
  answer = system.stopRecording();
  EXPECT_TRUE(answer.ok) << answer.sentence;
  std::printf("%s\n", answer.sentence.c_str());
  const std::string answer_recorded = answer.sentence;
  printTiming(system);
  EXPECT_TRUE(system.shutdown().ok);
  EXPECT_GT(looks.load(), 0);
  EXPECT_EQ(machine.bits, 0u);
  // However many cycles a loaded machine skipped: every row that was measured is there.
  const std::size_t number = answer_recorded.find(" has ");
  ASSERT_NE(number, std::string::npos);
  EXPECT_EQ(recording::loadRecording(folder + "/r.csv").rows(), std::atol(answer_recorded.c_str() + number + 5));
}

TEST(ThreadsAlone, PauseAndResumeInTheMiddleOfThePath) {
  const TemporaryFolder folder;
  LiveMachine machine(fake::robot());
  ControlSystem system(fake::robot(), fake::hardware(), deployment(folder, false), machine, nobodyOnIt());
  ASSERT_TRUE(system.start().ok);
  ASSERT_TRUE(system.enable().ok);
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  ASSERT_TRUE(system.loadReference(fake::smoothReference(fake::kHome, 0.01, 1.0)).ok);
  ASSERT_TRUE(system.play().ok);
  ASSERT_TRUE(system.waitFor(MachineState::Playing, 5.0));
  while (system.status().progress < 0.3)
    std::this_thread::yield();
  ASSERT_TRUE(system.pause().ok);
  ASSERT_TRUE(system.waitFor(MachineState::Paused, 20.0)) << system.status().fault_sentence;
  const double progress = system.status().progress;
  EXPECT_LT(progress, 1.0);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(system.status().progress, progress);
  ASSERT_TRUE(system.resume().ok);
  EXPECT_TRUE(system.waitFor(MachineState::Holding, 20.0)) << system.status().fault_sentence;
  EXPECT_NEAR(system.status().progress, 1.0, 1e-9);
  EXPECT_TRUE(system.shutdown().ok);
}

INSTANTIATE_TEST_SUITE_P(Of, Threads, ::testing::Bool(), [](const ::testing::TestParamInfo<bool>& info) {
  return info.param ? std::string("TwoActivities") : std::string("OneActivity");
});

TEST(ThreadsAlone, ShutDownSafelyWhenTheControllerIsDestroyedInMotion) {
  const mechanism::Robot robot = fake::robot();
  const TemporaryFolder folder;
  LiveMachine machine(robot);
  {
    ControlSystem system(robot, fake::hardware(), deployment(folder, false), machine, nobodyOnIt());
    ASSERT_TRUE(system.start().ok);
    ASSERT_TRUE(system.enable().ok);
  }
  EXPECT_EQ(machine.bits, 0u);
  EXPECT_EQ(machine.volts, AxisValues{});
}

}  // namespace
}  // namespace knee_robot::control
