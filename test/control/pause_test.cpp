// Pause, resume and speed scaling: the reference never jumps and never leaves its path, whatever is asked for in
// whichever order.
#include <gtest/gtest.h>

#include <cmath>

#include "system_rig.h"

namespace knee_robot::control {
namespace {

using fake::kHome;
using fake::Rig;

/// Steps the rig and watches the reference: speed changes from one millisecond to the next, distance between the axes.
class PausedPath : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(rig.play());
    last_ = rig.system.snapshot()->reference_m;
    cycle_ = rig.system.snapshot()->cycle;
  }
  void step() {
    rig.system.step();
    const TrackingRow row = *rig.system.snapshot();
    const AxisValues& now = row.reference_m;
    const double cycles = static_cast<double>(row.cycle - cycle_);  // a command takes cycles of its own
    const double speed = (now[0] - last_[0]) / (1e-3 * cycles);
    if (known_) hardest = std::max(hardest, std::abs(speed - speed_) / cycles);
    for (std::size_t i = 1; i < hardware::kAxes; ++i)
      apart = std::max(apart, std::abs(now[i] - now[0]));
    backwards = std::min(backwards, now[0] - last_[0]);
    fastest = std::max(fastest, speed);
    speed_ = speed;
    last_ = now;
    cycle_ = row.cycle;
    known_ = true;
  }
  void steps(int count) {
    for (int i = 0; i < count; ++i)
      step();
  }
  bool stepsUntil(MachineState state, double seconds) {
    for (int i = 0; i < static_cast<int>(1e3 * seconds) && rig.system.state() != state; ++i)
      step();
    return rig.system.state() == state;
  }
  /// A stop from full speed changes it by about 0.03 m/s in 0.3 s, in 30 pieces.
  void expectSmooth() const {
    EXPECT_LT(hardest, 0.002) << "m/s from one millisecond to the next";
    EXPECT_LT(apart, 1e-12) << "all four stay on the path";
    EXPECT_GT(backwards, -1e-9);
  }

  Rig rig;
  double hardest = 0.0, apart = 0.0, backwards = 0.0, fastest = 0.0;

 private:
  AxisValues last_{};
  std::int64_t cycle_ = 0;
  double speed_ = 0.0;
  bool known_ = false;
};

TEST_F(PausedPath, ComesToRestOnThePathAndGoesOnToItsEnd) {
  const Answer paused = rig.system.pause();
  ASSERT_TRUE(paused.ok) << paused.sentence;
  ASSERT_TRUE(stepsUntil(MachineState::Paused, 1.0));
  const ControlStatus at_rest = rig.system.status();
  EXPECT_EQ(at_rest.time_scale, 0.0);
  EXPECT_GT(at_rest.progress, 0.4);
  EXPECT_LT(at_rest.progress, 0.7);
  steps(500);
  EXPECT_EQ(rig.system.status().path_time_s, at_rest.path_time_s) << "it stands";
  EXPECT_EQ(rig.system.status().playing, "smooth.txt");
  EXPECT_TRUE(rig.system.pause().ok) << "again: no effect";
  ASSERT_TRUE(rig.system.resume().ok);
  ASSERT_TRUE(stepsUntil(MachineState::Holding, 3.0));
  EXPECT_NEAR(rig.system.status().progress, 1.0, 1e-9);
  EXPECT_NEAR(rig.system.snapshot()->reference_m[0], fake::kHome + 0.03, 1e-9);
  expectSmooth();
}

TEST_F(PausedPath, PlaysAtThePartOfTheSpeedThatIsAskedFor) {
  const Answer slower = rig.system.setSpeed(25.0);
  ASSERT_TRUE(slower.ok) << slower.sentence;
  steps(1000);
  EXPECT_NEAR(rig.system.status().time_scale, 0.25, 1e-12);
  EXPECT_EQ(rig.system.status().speed_percent, 25.0);
  EXPECT_EQ(rig.system.state(), MachineState::Playing);
  ASSERT_TRUE(stepsUntil(MachineState::Holding, 10.0));
  expectSmooth();
}

TEST_F(PausedPath, StandsAtZeroPercentAndGoesOnWithMore) {
  ASSERT_TRUE(rig.system.setSpeed(0.0).ok);
  ASSERT_TRUE(stepsUntil(MachineState::Paused, 1.0));
  EXPECT_NE(rig.system.resume().sentence.find("0 %"), std::string::npos);
  steps(300);
  EXPECT_EQ(rig.system.state(), MachineState::Paused);
  ASSERT_TRUE(rig.system.setSpeed(100.0).ok);
  ASSERT_TRUE(stepsUntil(MachineState::Holding, 3.0));
  expectSmooth();
}

TEST_F(PausedPath, StaysSmoothHoweverOftenAndHoweverOddlyItIsAsked) {
  const double speeds[] = {100, 0, 37, 100, 3, 80, 0, 100};
  for (int i = 0; i < 40 && rig.system.state() != MachineState::Holding; ++i) {
    (void)rig.system.setSpeed(speeds[i % 8]);
    if (i % 3 == 0) (void)rig.system.pause();
    steps(17 + i);
    if (i % 3 == 0) (void)rig.system.resume();
    steps(11);
  }
  ASSERT_TRUE(rig.system.setSpeed(100).ok);
  (void)rig.system.resume();
  ASSERT_TRUE(stepsUntil(MachineState::Holding, 5.0));
  EXPECT_NEAR(rig.system.snapshot()->reference_m[0], fake::kHome + 0.03, 1e-9);
  expectSmooth();
}

TEST_F(PausedPath, RefusesSpeedsThatAreNone) {
  for (const double bad : {-1.0, 100.5, std::nan(""), 1e300}) {
    EXPECT_FALSE(rig.system.setSpeed(bad).ok) << bad;
  }
  EXPECT_EQ(rig.system.status().speed_percent, 100.0);
}

TEST_F(PausedPath, IsNotResumedByWhoAskedForItBeforeSomebodyPaused) {
  ASSERT_TRUE(rig.system.pause().ok);
  ASSERT_TRUE(stepsUntil(MachineState::Paused, 1.0));
  const WishesSoFar asked = rig.system.wishesSoFar();
  ASSERT_TRUE(rig.system.pause().ok);
  const Answer answer = rig.system.resume(asked);
  EXPECT_FALSE(answer.ok);
  EXPECT_NE(answer.sentence.find("paused"), std::string::npos) << answer.sentence;
  steps(300);
  EXPECT_EQ(rig.system.state(), MachineState::Paused);
  EXPECT_TRUE(rig.system.resume().ok);
  EXPECT_TRUE(stepsUntil(MachineState::Holding, 3.0));
}

TEST_F(PausedPath, ThatEndsBeforeItIsAtRestIsKnownToHaveBeenPaused) {
  while (rig.system.status().path_time_s < rig.system.status().path_duration_s - 0.05)
    steps(1);
  EXPECT_FALSE(rig.system.status().pause_asked);
  ASSERT_TRUE(rig.system.pause().ok);
  ASSERT_TRUE(stepsUntil(MachineState::Holding, 1.0));
  EXPECT_TRUE(rig.system.status().pause_asked);
  ASSERT_TRUE(rig.system.loadReference(fake::smoothReference(fake::kHome + 0.03, -0.01, 1.0)).ok);
  ASSERT_TRUE(rig.system.play().ok) << "asked for behind it";
  steps(1);
  EXPECT_FALSE(rig.system.status().pause_asked);
}

TEST_F(PausedPath, IsGivenUpByStopAndNotResumedAfterwards) {
  ASSERT_TRUE(rig.system.pause().ok);
  ASSERT_TRUE(stepsUntil(MachineState::Paused, 1.0));
  EXPECT_FALSE(rig.system.play().ok) << "stop first";
  EXPECT_FALSE(rig.system.loadReference(fake::smoothReference(fake::kHome, 0.01, 1.0)).ok);
  ASSERT_TRUE(rig.system.stop().ok);
  ASSERT_TRUE(stepsUntil(MachineState::Holding, 1.0));
  EXPECT_FALSE(rig.system.resume().ok);
  steps(300);
  EXPECT_EQ(rig.system.state(), MachineState::Holding);
  expectSmooth();
}

TEST_F(PausedPath, IsNotResumedAfterDisableAndEnable) {
  ASSERT_TRUE(rig.system.pause().ok);
  ASSERT_TRUE(stepsUntil(MachineState::Paused, 1.0));
  ASSERT_TRUE(rig.system.disable().ok);
  ASSERT_TRUE(rig.system.enable().ok);
  EXPECT_FALSE(rig.system.resume().ok);
  rig.system.run(0.5);
  EXPECT_EQ(rig.system.state(), MachineState::Holding);
}

TEST_F(PausedPath, EndsInTheSafeStopWhenAFaultComesWhileItIsPaused) {
  ASSERT_TRUE(rig.system.pause().ok);
  ASSERT_TRUE(stepsUntil(MachineState::Paused, 1.0));
  rig.injection.silent = "Sync";
  EXPECT_TRUE(rig.system.waitFor(MachineState::Faulted, 2.0));
  EXPECT_EQ(rig.system.status().fault_name, "set_point_stale");
  EXPECT_EQ(rig.system.status().safe_stops, 1u);
}

TEST(SpeedScaling, StartsAtTheSpeedThatWasSetBefore) {
  Rig rig;
  rig.hold();
  ASSERT_TRUE(rig.system.setSpeed(50.0).ok);
  ASSERT_TRUE(rig.system.loadReference(fake::smoothReference(fake::kHome, 0.03, 2.0)).ok);
  ASSERT_TRUE(rig.system.play().ok);
  rig.system.run(2.0);
  EXPECT_NEAR(rig.system.status().path_time_s, 1.0, 0.03);
  EXPECT_NEAR(rig.system.status().progress, 0.5, 0.02);
}

TEST(RunTimeProperties, ChangeGainsWithoutAJumpOfForce) {
  Rig rig, unchanged;
  for (Rig* one : {&rig, &unchanged}) {
    one->hold();
    one->machine.axes[0].load_N = 80.0;  // pushed away, so that there is an error for the gain to act on
    one->system.run(0.01);
  }
  const TrackingRow row = *rig.system.snapshot();
  const double jump = 40000.0 * std::abs(row.reference_m[0] - row.position_m[0]);
  const Answer changed = rig.system.setProperty("Driver1", "proportional_N_per_m", "20000");
  ASSERT_TRUE(changed.ok) << changed.sentence;
  EXPECT_NE(changed.sentence.find("was 60000"), std::string::npos) << changed.sentence;
  for (Rig* one : {&rig, &unchanged})
    one->system.step();
  EXPECT_GT(jump, 4.0) << "what it would be without the integral's help";
  EXPECT_NEAR(rig.system.snapshot()->force_N[0], unchanged.system.snapshot()->force_N[0], 0.1 * jump);
}

TEST(RunTimeProperties, RefuseWhatIsOutOfRangeUnknownOrNotDeclaredSo) {
  Rig rig;
  rig.hold();
  EXPECT_FALSE(rig.system.setProperty("Driver1", "proportional_N_per_m", "-1").ok);
  EXPECT_FALSE(rig.system.setProperty("Driver1", "proportional_N_per_m", "nan").ok);
  EXPECT_FALSE(rig.system.setProperty("Driver1", "proportional_N_per_m", "1} , {x: 2").ok);
  EXPECT_FALSE(rig.system.setProperty("Driver1", "proportional_N_per_m", "").ok);
  EXPECT_FALSE(rig.system.setProperty("Driver1", "axis", "2").ok);
  EXPECT_FALSE(rig.system.setProperty("Driver1", "nonsense", "2").ok);
  EXPECT_FALSE(rig.system.setProperty("Driver9", "axis", "2").ok);
  int changeable = 0;
  for (const rt::PropertyReport& one : rig.system.properties()) {
    changeable += one.at_run_time ? 1 : 0;
    EXPECT_FALSE(one.description.empty()) << one.component << "." << one.name;
    EXPECT_EQ(one.at_run_time && one.range.empty(), false);
  }
  EXPECT_GE(changeable, 16);
}

TEST(Statistics, CountEveryComponentsUpdates) {
  Rig rig;
  rig.hold();
  const auto reports = rig.system.statistics();
  ASSERT_EQ(reports.size(), 1u);
  const auto& servo = reports[0];
  EXPECT_EQ(servo.components.size(), rig.system.deployment().components().size());
  for (const auto& one : servo.components) {
    const auto share = static_cast<std::uint64_t>(one.period / servo.period);
    EXPECT_NEAR(static_cast<double>(one.updates), static_cast<double>(servo.cycles / share), 1.0) << one.name;
    EXPECT_EQ(one.periods.max, one.period) << one.name;
  }
  EXPECT_NE(rt::toText(reports).find("Supervisor"), std::string::npos);
}

}  // namespace
}  // namespace knee_robot::control
