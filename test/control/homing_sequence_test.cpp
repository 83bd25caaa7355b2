#include "src/control/homing_sequence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "supervisor_view_of.h"

namespace knee_robot::control {
namespace {

using Progress = HomingSequence::Progress;

constexpr rt::Nanoseconds kCycle = 1'000'000;

HardwareFile byHardStops() {
  HardwareFile hardware = fake::hardware();
  hardware.homing.method = HomingMethod::HardStop;
  hardware.homing.order = {4, 1, 2, 3};
  for (HomingAxis& axis : hardware.homing.axes)
    axis.length_m = 0.55;
  return hardware;
}

class HomingSearch : public ::testing::Test {
 protected:
  HomingSearch() {
    sequence.start(true);
    sequence.prepare(true);
    sequence.begin(0);
  }
  Progress cycles(int count) {
    Progress progress = Progress::Running;
    for (int i = 0; i < count && progress == Progress::Running; ++i)
      progress = sequence.step(view, now += kCycle);
    return progress;
  }
  /// Waits until an axis is asked, and lets its Driver end the search at `found_m`.
  Progress find(int axis, double found_m) {
    EXPECT_EQ(cycles(510), Progress::Running);
    EXPECT_EQ(sequence.searching(), 1 << (axis - 1));
    AxisCommand& command = view.commands[static_cast<std::size_t>(axis - 1)];
    command.homing = HomingPhase::Found;
    command.home_m = found_m;
    const Progress progress = cycles(1);
    command.homing = HomingPhase::Idle;
    return progress;
  }

  HomingSequence sequence{fake::robot(), byHardStops()};
  SupervisorView view = fake::wellView(DriveLevel::Released);
  rt::Nanoseconds now = 0;
};

TEST_F(HomingSearch, SearchesOneAxisAfterTheOtherInTheFilesOrderAndShiftsOnlyAtTheEnd) {
  EXPECT_EQ(find(4, 0.61), Progress::Running);
  EXPECT_EQ(find(1, 0.62), Progress::Running);
  EXPECT_EQ(find(2, 0.63), Progress::Running);
  EXPECT_EQ(find(3, 0.64), Progress::Found);
  EXPECT_FALSE(sequence.isHomed()) << "the drives are still on";
  EXPECT_EQ(sequence.setting().number, 0u);
  EXPECT_TRUE(sequence.end(false));
  EXPECT_TRUE(sequence.isHomed());
  const AxisValues shift = sequence.setting().shift_m;
  EXPECT_NEAR(shift[0], 0.55 - 0.62, 1e-12);
  EXPECT_NEAR(shift[3], 0.55 - 0.61, 1e-12);
}

TEST_F(HomingSearch, AsksTheNextAxisOnlyWhenThePlatformHasBeenAtRestForHalfASecond) {
  for (int i = 0; i < 50; ++i) {
    view.measured.position_m[2] += 0.0005;
    ASSERT_EQ(cycles(100), Progress::Running);
    ASSERT_EQ(sequence.searching(), 0);
  }
  cycles(500);
  EXPECT_EQ(sequence.searching(), 1 << 3);
}

TEST_F(HomingSearch, NamesTheAxisThatFailed) {
  cycles(510);
  view.commands[3].homing = HomingPhase::Failed;
  EXPECT_EQ(cycles(1), Progress::Failed);
  EXPECT_EQ(sequence.failedAxis(), 4);
  EXPECT_FALSE(sequence.end(true));
  EXPECT_FALSE(sequence.isHomed());
}

TEST_F(HomingSearch, ChangesNothingWhenItIsBrokenOffOrAFaultComesAtItsEnd) {
  find(4, 0.61);
  EXPECT_FALSE(sequence.end(false)) << "one of four axes";
  sequence.prepare(true);
  for (const int axis : {4, 1, 2, 3})
    find(axis, 0.6);
  EXPECT_FALSE(sequence.end(true));
  EXPECT_FALSE(sequence.isHomed());
  EXPECT_FALSE(sequence.end(false)) << "it is over";
}

class HomingByHand : public ::testing::Test {
 protected:
  HomingByHand() { sequence.start(true); }
  static HardwareFile placedByHand() {
    HardwareFile hardware = fake::hardware();
    hardware.homing.method = HomingMethod::HandPlaced;
    return hardware;
  }
  /// Stands at home, and is told so.
  AxisValues takenForHome() {
    AxisValues measured{};
    measured.fill(fake::kHome);
    EXPECT_TRUE(sequence.takeForHome(measured).shifts);
    return measured;
  }

  HomingSequence sequence{fake::robot(), placedByHand()};
};

TEST_F(HomingByHand, TakesThePlaceForHomeAndRefusesAnotherOneFarFromTheCounters) {
  AxisValues measured{0.1, 0.2, 0.3, 0.4};
  EXPECT_TRUE(sequence.takeForHome(measured).shifts);
  EXPECT_TRUE(sequence.isHomed());
  EXPECT_NEAR(sequence.setting().shift_m[1], fake::kHome - 0.2, 1e-12);
  measured.fill(fake::kHome);
  measured[2] += 0.006;
  const HomingSequence::Taken refused = sequence.takeForHome(measured);
  EXPECT_EQ(refused.result, RequestResult::HomeShifted);
  EXPECT_EQ(refused.axis, 3);
  EXPECT_NEAR(refused.distance_m, 0.006, 1e-12);
  EXPECT_EQ(sequence.setting().number, 1u);
  sequence.forget(2);
  EXPECT_FALSE(sequence.isHomed());
  EXPECT_TRUE(sequence.takeForHome(measured).shifts) << "the counters of a lost axis say nothing against it";
}

TEST_F(HomingByHand, StillBelievesTheOtherCountersWhenOneAxisHasLostItsHome) {
  AxisValues measured = takenForHome();
  sequence.forget(2);
  measured[2] += 0.2;
  measured[0] -= 0.03;
  const HomingSequence::Taken refused = sequence.takeForHome(measured);
  EXPECT_EQ(refused.result, RequestResult::HomeShifted);
  EXPECT_EQ(refused.axis, 1);
  EXPECT_NEAR(refused.distance_m, 0.03, 1e-12);
  EXPECT_FALSE(sequence.isHomed());
  measured[0] = std::nan("");
  EXPECT_EQ(sequence.takeForHome(measured).result, RequestResult::HomeShifted);
  measured[0] = fake::kHome;
  EXPECT_TRUE(sequence.takeForHome(measured).shifts);
  EXPECT_TRUE(sequence.isHomed());
}

TEST_F(HomingByHand, IsNotMovedFartherBySmallStepsThanByALargeOne) {
  AxisValues measured = takenForHome();
  measured[1] = fake::kHome + 0.003;
  ASSERT_TRUE(sequence.takeForHome(measured).shifts);
  const HomingSequence::Taken refused = sequence.takeForHome(measured);  // 3 mm more by the counters of now
  EXPECT_EQ(refused.result, RequestResult::HomeShifted);
  EXPECT_EQ(refused.axis, 2);
  EXPECT_NEAR(refused.distance_m, 0.006, 1e-12);
  measured[1] = fake::kHome - 0.003;
  EXPECT_TRUE(sequence.takeForHome(measured).shifts) << "back to the first one";
  sequence.forget(1);
  measured[1] = fake::kHome + 0.004;
  ASSERT_TRUE(sequence.takeForHome(measured).shifts);
  measured[1] = fake::kHome + 0.003;
  EXPECT_TRUE(sequence.takeForHome(measured).shifts) << "what was before its counters were lost does not count";
}

TEST(HomingAssumed, HoldsFromTheFirstStartOnlyAndIsNotRegainedByAStart) {
  HomingSequence sequence(fake::robot(), fake::hardware());
  sequence.start(true);
  EXPECT_TRUE(sequence.isHomed());
  sequence.forget(0);
  sequence.start(false);
  EXPECT_FALSE(sequence.isHomed());
}

}  // namespace
}  // namespace knee_robot::control
