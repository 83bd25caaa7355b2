// How the drives come on, step by step, without a machine.
#include "src/control/enabling_sequence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "supervisor_view_of.h"

namespace knee_robot::control {
namespace {

constexpr rt::Nanoseconds kEnablingCycle = 1'000'000;

class Enabling : public ::testing::Test {
 protected:
  Enabling() : sequence(fake::hardware()) { sequence.begin(0); }
  /// One cycle; the outputs obey at once.
  EnablingSequence::Step cycle() {
    now += kEnablingCycle;
    const EnablingSequence::Step step = sequence.step(view, settings, now);
    view.written.level = step.level;
    return step;
  }
  /// Seconds until `level` is ordered; gives up after 5.
  double timeTo(DriveLevel level) {
    while (now < 5'000 * kEnablingCycle) {
      if (cycle().level == level) break;
    }
    return rt::toSeconds(now);
  }

  EnablingSequence sequence;
  EnablingSequence::Settings settings;
  SupervisorView view = fake::wellView(DriveLevel::Energised);
  rt::Nanoseconds now = 0;
};

TEST_F(Enabling, WaitsForTheDrivesThenForTheLoopsThenForTheHoldDevices) {
  EXPECT_NEAR(timeTo(DriveLevel::HeldByDrivers), 0.02, 0.002);
  EXPECT_NEAR(timeTo(DriveLevel::Released), 0.02 + 0.05, 0.004);
  while (!cycle().done)
    ASSERT_LT(now, 1000 * kEnablingCycle);
  EXPECT_NEAR(rt::toSeconds(now), 0.02 + 0.05 + 0.03, 0.006);
}

TEST_F(Enabling, ReleasesNothingWhileOneFeedforwardIsIncomplete) {
  view.commands[2].loaded = false;
  timeTo(DriveLevel::HeldByDrivers);
  for (int i = 0; i < 1000; ++i)
    ASSERT_EQ(cycle().level, DriveLevel::HeldByDrivers);
  view.commands[2].loaded = true;
  const rt::Nanoseconds complete = now;
  timeTo(DriveLevel::Released);
  EXPECT_NEAR(rt::toSeconds(now - complete), 0.05, 0.002);
}

TEST_F(Enabling, ReleasesNothingWithoutClosedLoopsHoweverShortTheyHaveToSettle) {
  settings.settle_s = 0.0;
  view.commands[2].active = false;
  timeTo(DriveLevel::HeldByDrivers);
  for (int i = 0; i < 100; ++i)
    ASSERT_EQ(cycle().level, DriveLevel::HeldByDrivers);
}

TEST_F(Enabling, ReleasesNothingInTheCycleInWhichALoopOpens) {
  timeTo(DriveLevel::HeldByDrivers);
  const rt::Nanoseconds closed = now;
  while (now - closed < 49 * kEnablingCycle)
    ASSERT_EQ(cycle().level, DriveLevel::HeldByDrivers);
  view.commands[3].active = false;
  for (int i = 0; i < 5; ++i)
    ASSERT_EQ(cycle().level, DriveLevel::HeldByDrivers);
}

TEST_F(Enabling, CountsALevelFromWhenTheOutputsHaveWrittenIt) {
  timeTo(DriveLevel::HeldByDrivers);
  view.written.level = DriveLevel::Energised;  // AxesOutput has not got so far
  for (int i = 0; i < 100; ++i) {
    now += kEnablingCycle;
    ASSERT_EQ(sequence.step(view, settings, now).level, DriveLevel::HeldByDrivers);
  }
}

TEST_F(Enabling, IsAFaultWhenItTakesTooLong) {
  view.commands[0].active = false;
  EnablingSequence::Step step;
  while (step.fault.fault == Fault::None) {
    step = cycle();
    ASSERT_LE(now, 2'001 * kEnablingCycle);
  }
  EXPECT_EQ(step.fault.fault, Fault::EnableTimeout);
  EXPECT_EQ(step.level, DriveLevel::HeldByDrivers) << "the holding brakes stay engaged";
  EXPECT_FALSE(step.done);
}

TEST_F(Enabling, NamesTheAxisWhoseBrakeGivesWay) {
  settings.brake_test_N = 120.0;
  while (cycle().brake_test_N[1] == 0.0)
    ASSERT_LT(now, 1000 * kEnablingCycle);
  view.measured.position_m[1] -= 1.1 * settings.brake_slip_m;
  const EnablingSequence::Step step = cycle();
  EXPECT_EQ(step.fault.fault, Fault::HoldDeviceSlips);
  EXPECT_EQ(step.fault.axis, 2);
  EXPECT_EQ(step.brake_test_N, AxisValues{});
  EXPECT_EQ(step.level, DriveLevel::Energised);
}

TEST(BrakeTesting, PushesEveryBrakeBothWaysOneAfterTheOtherAndNeverHarder) {
  BrakeTest test(fake::hardware());
  AxisValues home;
  home.fill(fake::kHome);
  test.standAt(home);
  AxisValues lowest{}, highest{};
  double time = 0.0;
  for (BrakeTest::Step step; !step.done; time += 0.001) {
    ASSERT_LT(time, 1.0);
    step = test.step(time, home, 120.0, 5e-4);
    ASSERT_EQ(step.slipped, 0);
    int pushed = 0;
    for (std::size_t i = 0; i < hardware::kAxes; ++i) {
      lowest[i] = std::min(lowest[i], step.force_N[i]);
      highest[i] = std::max(highest[i], step.force_N[i]);
      if (step.force_N[i] != 0.0) ++pushed;
    }
    ASSERT_LE(pushed, 1);
  }
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    EXPECT_DOUBLE_EQ(lowest[i], -120.0);
    EXPECT_DOUBLE_EQ(highest[i], 120.0);
  }
}

TEST(BrakeTesting, LeavesAxesWithoutABrakeAlone) {
  HardwareFile hardware = fake::hardware();
  hardware.axes[2].hold_device = HoldDevice::ShortedWindings;
  BrakeTest test(hardware);
  EXPECT_FALSE(test.coversAllAxes());
  AxisValues home;
  home.fill(fake::kHome);
  test.standAt(home);
  home[2] -= 0.01;  // sinks slowly
  for (double time = 0.0; time < 0.4; time += 0.001) {
    const BrakeTest::Step step = test.step(time, home, 120.0, 5e-4);
    ASSERT_EQ(step.slipped, 0);
    ASSERT_EQ(step.force_N[2], 0.0);
  }
}

TEST(BrakeTesting, APositionThatIsNoNumberIsABrakeThatSlips) {
  BrakeTest test(fake::hardware());
  AxisValues home;
  home.fill(fake::kHome);
  test.standAt(home);
  home[0] = std::nan("");
  EXPECT_EQ(test.step(0.01, home, 120.0, 5e-4).slipped, 1);
}

}  // namespace
}  // namespace knee_robot::control
