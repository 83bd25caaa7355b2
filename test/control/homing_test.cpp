// Incremental encoders know nothing when they are switched on: by hand, against a switch, against the end of the
// stroke.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "system_rig.h"

namespace knee_robot::control {
namespace {

using fake::kHome;
using fake::Rig;

HardwareFile withHoming(HomingMethod method) {
  HardwareFile hardware = fake::hardware();
  hardware.homing.method = method;
  HomingAxis axis;
  axis.length_m = 0.55;
  axis.direction = -1;
  axis.speed_m_per_s = 0.02;
  axis.force_N = 60.0;
  axis.back_off_m = 0.01;
  axis.travel_m = 0.2;
  hardware.homing.axes.fill(axis);
  hardware.homing.axes[3].force_N = 150.0;
  hardware.homing.order = {4, 1, 2, 3};
  return hardware;
}

/// The robot really stands 0.03 m above home, and nobody knows.
void displace(Rig& rig) {
  rig.machine.encoder_zero = fake::kHome + 0.03;
  for (auto& axis : rig.machine.axes)
    axis.position = fake::kHome + 0.03;
}

void expectLengthsAreTrue(const Rig& rig) {
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    EXPECT_NEAR(rig.system.snapshot()->position_m[i], rig.machine.axes[i].position, 3e-4) << "axis " << i + 1;
}

TEST(Homing, NothingMovesBeforeTheAxesKnowWhereTheyAre) {
  for (const HomingMethod method : {HomingMethod::HandPlaced, HomingMethod::Switch, HomingMethod::HardStop}) {
    Rig rig(withHoming(method));
    ASSERT_TRUE(rig.system.start().ok);
    EXPECT_FALSE(rig.system.status().homed);
    const Answer refused = rig.system.enable();
    EXPECT_FALSE(refused.ok);
    EXPECT_NE(refused.sentence.find("home"), std::string::npos) << refused.sentence;
    EXPECT_EQ(rig.system.state(), MachineState::Disabled);
  }
}

TEST(Homing, ByHandIsConfirmedByTheOperatorOnlyWithTheDrivesOff) {
  Rig rig(withHoming(HomingMethod::HandPlaced));
  ASSERT_TRUE(rig.system.start().ok);
  EXPECT_FALSE(rig.system.home().ok);
  const Answer confirmed = rig.system.confirmHome();
  ASSERT_TRUE(confirmed.ok) << confirmed.sentence;
  rig.system.run(0.01);
  EXPECT_TRUE(rig.system.status().homed);
  expectLengthsAreTrue(rig);
  ASSERT_TRUE(rig.system.enable().ok);
  EXPECT_FALSE(rig.system.confirmHome().ok) << "not with the drives on";
}

TEST(Homing, NobodyComesToTheRobotWhileHomeIsBeingConfirmed) {
  Rig rig(withHoming(HomingMethod::HandPlaced));
  ASSERT_TRUE(rig.system.start().ok);
  int asked = 0, came = 0;
  rig.system.setPlant([&](rt::Nanoseconds time) {
    rig.machine.advanceTo(rt::toSeconds(time));
    ++asked;
    if (rig.system.declareEmpty().ok) ++came;
  });
  EXPECT_TRUE(rig.system.confirmHome().ok);
  EXPECT_GT(asked, 0);
  EXPECT_EQ(came, 0);
}

TEST(Homing, ByHandTakesThePlaceWhereTheRobotStandsForHome) {
  Rig rig(withHoming(HomingMethod::HandPlaced));
  displace(rig);
  ASSERT_TRUE(rig.system.start().ok);
  for (int i = 0; i < 600; ++i) {
    for (auto& axis : rig.machine.axes)
      axis.position -= 5e-5;  // by hand, 50 mm/s
    rig.system.step();
  }
  const Answer moving = rig.system.confirmHome();
  EXPECT_FALSE(moving.ok);
  EXPECT_NE(moving.sentence.find("moves"), std::string::npos) << moving.sentence;
  EXPECT_FALSE(rig.system.status().homed);
  rig.system.run(0.1);
  ASSERT_TRUE(rig.system.confirmHome().ok);
  rig.system.run(0.01);
  expectLengthsAreTrue(rig);
}

class HomingMoves : public ::testing::TestWithParam<HomingMethod> {
 protected:
  HardwareFile hardware() const {
    HardwareFile hardware = withHoming(GetParam());
    if (GetParam() == HomingMethod::Switch) hardware.homing.switch_bit = 2;
    return hardware;
  }
  void prepare(Rig& rig) const {
    displace(rig);
    if (GetParam() == HomingMethod::Switch) rig.machine.switch_bit = 2;
    for (auto& axis : rig.machine.axes) {
      if (GetParam() == HomingMethod::Switch) axis.switch_below = 0.55;
      if (GetParam() == HomingMethod::HardStop) axis.stop_min = 0.55;
    }
  }
};

TEST_P(HomingMoves, FindHomeOneAxisAfterTheOtherSlowlyAndWithLowForce) {
  Rig rig(hardware());
  prepare(rig);
  ASSERT_TRUE(rig.system.start().ok);
  const Answer begun = rig.system.home();
  ASSERT_TRUE(begun.ok) << begun.sentence;
  double fastest = 0.0;
  int moving_at_once = 0, cycles = 0, homing = 0;
  std::array<double, hardware::kAxes> before{};  // 50 ms ago: test pulses shake the axes for some milliseconds
  while (rig.system.state() != MachineState::Disabled && rig.system.state() != MachineState::Faulted &&
         ++cycles < 60'000) {
    rig.system.step();
    if (rig.system.state() != MachineState::Homing || ++homing < 400) continue;  // the brakes have just opened
    if (homing % 50 != 0) continue;
    int moving = 0;
    for (std::size_t i = 0; i < hardware::kAxes; ++i) {
      const double mean_m_per_s = (rig.machine.axes[i].position - before[i]) / 0.05;
      before[i] = rig.machine.axes[i].position;
      if (homing == 400) continue;
      fastest = std::max(fastest, std::abs(mean_m_per_s));
      moving += std::abs(mean_m_per_s) > 0.01 ? 1 : 0;
    }
    moving_at_once = std::max(moving_at_once, moving);
  }
  EXPECT_EQ(rig.system.state(), MachineState::Disabled) << rig.system.status().fault_sentence;
  EXPECT_TRUE(rig.system.status().homed);
  EXPECT_EQ(rig.system.status().safe_stops, 1u);
  EXPECT_LT(fastest, 0.07) << "0.02 m/s, and a little more when it turns round at full force";
  EXPECT_EQ(moving_at_once, 1);
  rig.system.run(0.01);
  expectLengthsAreTrue(rig);
  std::printf("found within %.3f, %.3f, %.3f, %.3f mm\n",
              1e3 * (rig.system.snapshot()->position_m[0] - rig.machine.axes[0].position),
              1e3 * (rig.system.snapshot()->position_m[1] - rig.machine.axes[1].position),
              1e3 * (rig.system.snapshot()->position_m[2] - rig.machine.axes[2].position),
              1e3 * (rig.system.snapshot()->position_m[3] - rig.machine.axes[3].position));
  const Answer enabled = rig.system.enable();
  EXPECT_TRUE(enabled.ok) << enabled.sentence;
  rig.system.run(1.0);
  EXPECT_EQ(rig.system.state(), MachineState::Holding);
}

TEST_P(HomingMoves, GiveUpWhenThereIsNothingToBeFound) {
  Rig rig(hardware());
  prepare(rig);
  for (auto& axis : rig.machine.axes) {
    axis.switch_below = -10.0;
    axis.stop_min = -10.0;
  }
  ASSERT_TRUE(rig.system.start().ok);
  ASSERT_TRUE(rig.system.home().ok);
  EXPECT_TRUE(rig.system.waitFor(MachineState::Faulted, 60.0));
  EXPECT_EQ(rig.system.status().fault_name, "homing_failed");
  EXPECT_EQ(rig.system.status().fault_axis, 4);
  EXPECT_FALSE(rig.system.status().homed);
  ASSERT_TRUE(rig.system.resetFaults().ok);
  EXPECT_FALSE(rig.system.enable().ok) << "still not homed";
}

TEST_P(HomingMoves, FindNoHomeWhereAnAxisIsBlockedOrItsEncoderIsDead) {
  for (const std::size_t axis : {3u, 0u}) {
    for (const bool blind : {false, true}) {
      HardwareFile file = hardware();
      for (HomingAxis& one : file.homing.axes)
        one.back_off_m = HomingMove::kLeastBackOff_m;
      Rig rig(file);
      prepare(rig);
      ASSERT_TRUE(rig.system.start().ok);
      ASSERT_TRUE(rig.system.home().ok);
      ASSERT_TRUE(rig.system.waitFor(MachineState::Homing, 2.0));
      (blind ? rig.machine.axes[axis].encoder_frozen : rig.machine.axes[axis].jammed) = true;
      EXPECT_TRUE(rig.system.waitFor(MachineState::Faulted, 60.0)) << axis + 1 << (blind ? " blind" : " blocked");
      EXPECT_FALSE(rig.system.status().homed) << axis + 1 << (blind ? " blind" : " blocked");
    }
  }
}

/// What an axis makes of its reference; `stands`: it does not shorten, by its friction or its stop.
HomingPhase whereItEnds(const std::function<bool(double)>& stands) {
  HomingMove move;
  HomingAxis axis;
  axis.speed_m_per_s = 0.01;
  double position = 0.60, before = position;
  move.begin(axis, false, position);
  for (int k = 0; k < 60'000 && move.phase() < HomingPhase::Found; ++k) {
    const HomingMove::Output now = move.step(position, (position - before) / 1e-3, false, 1e-3, 300.0);
    before = position;
    if (now.reference_m > position || !stands(position)) position = now.reference_m;
  }
  return move.phase();
}

TEST(HomingMove, DoesNotTakeFrictionForAStop) {
  EXPECT_EQ(whereItEnds([](double position) { return position <= 0.55; }), HomingPhase::Found);
  EXPECT_EQ(whereItEnds([](double position) { return position <= 0.60; }), HomingPhase::Found)
      << "it stands there already";
  EXPECT_EQ(whereItEnds([](double) { return true; }), HomingPhase::Failed) << "10 mm beside where it stood first";
  int blocked = 0;
  EXPECT_EQ(whereItEnds([&](double position) { return ++blocked < 2000 || position <= 0.55; }), HomingPhase::Failed)
      << "it goes on where it stood first";
}

TEST_P(HomingMoves, AreEndedByStopWithoutHavingFoundAnything) {
  Rig rig(hardware());
  prepare(rig);
  ASSERT_TRUE(rig.system.start().ok);
  ASSERT_TRUE(rig.system.home().ok);
  ASSERT_TRUE(rig.system.waitFor(MachineState::Homing, 2.0));
  rig.system.run(0.5);
  const double before = rig.lowest();
  ASSERT_TRUE(rig.system.stop().ok);
  ASSERT_TRUE(rig.system.waitFor(MachineState::Disabled, 2.0));
  EXPECT_FALSE(rig.system.status().homed);
  EXPECT_GT(rig.lowest(), before - 2e-3);
  EXPECT_EQ(rig.system.status().safe_stops, 1u);
}

TEST(Homing, TakesNoSwitchForHomeThatStaysClosedOrClosesForAMoment) {
  for (const bool stays : {true, false}) {
    HardwareFile hardware = withHoming(HomingMethod::Switch);
    hardware.homing.switch_bit = 2;
    Rig rig(hardware);
    displace(rig);
    rig.machine.switch_bit = 2;
    for (auto& axis : rig.machine.axes)
      axis.switch_below = 0.55;
    auto& searching = rig.machine.axes[3];
    ASSERT_TRUE(rig.system.start().ok);
    ASSERT_TRUE(rig.system.home().ok);
    ASSERT_TRUE(rig.system.waitFor(MachineState::Homing, 2.0));
    for (int i = 0; i < 5000 && searching.position > fake::kHome + 0.02; ++i)
      rig.system.step();
    searching.switch_below = 10.0;
    rig.system.run(0.002);
    if (!stays) searching.switch_below = 0.55;
    EXPECT_TRUE(rig.system.waitFor(MachineState::Faulted, 60.0)) << (stays ? "stays closed" : "for a moment");
    EXPECT_EQ(rig.system.status().fault_name, "homing_failed");
    EXPECT_EQ(rig.system.status().fault_axis, 4);
    EXPECT_FALSE(rig.system.status().homed)
        << "lengths wrong by " << 1e3 * (rig.system.snapshot()->position_m[3] - searching.position) << " mm";
  }
}

INSTANTIATE_TEST_SUITE_P(Against, HomingMoves, ::testing::Values(HomingMethod::Switch, HomingMethod::HardStop),
                         [](const ::testing::TestParamInfo<HomingMethod>& info) {
                           return info.param == HomingMethod::Switch ? std::string("ASwitch")
                                                                     : std::string("AHardStop");
                         });

TEST(Homing, IsLostWithAnEncoderThatJumped) {
  Rig rig(withHoming(HomingMethod::HandPlaced));
  ASSERT_TRUE(rig.system.start().ok);
  ASSERT_TRUE(rig.system.confirmHome().ok);
  ASSERT_TRUE(rig.system.enable().ok);
  rig.machine.axes[2].encoder_offset_m = 0.02;
  EXPECT_TRUE(rig.system.waitFor(MachineState::Faulted, 2.0));
  EXPECT_EQ(rig.system.status().fault_name, "encoder_jump");
  EXPECT_TRUE(rig.system.status().axis_homed[0]);
  EXPECT_FALSE(rig.system.status().axis_homed[2]);
  ASSERT_TRUE(rig.system.resetFaults().ok);
  EXPECT_FALSE(rig.system.enable().ok) << "home again first";
  ASSERT_TRUE(rig.system.confirmHome().ok);
  EXPECT_TRUE(rig.system.enable().ok);
}

}  // namespace
}  // namespace knee_robot::control
