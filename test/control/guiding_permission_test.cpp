#include "src/control/guiding_permission.h"

#include <gtest/gtest.h>

#include "supervisor_view_of.h"

namespace knee_robot::control {
namespace {

HardwareFile withSwitch() {
  HardwareFile hardware = fake::hardware();
  hardware.enabling_switch_bit = 3;
  return hardware;
}

/// Drives on, the switch was let go of and is held now.
class Guiding : public ::testing::Test {
 protected:
  Guiding() {
    permission.start();
    permission.driversEnabled();
    hold(false);
    hold(true);
  }
  void hold(bool held) {
    view.measured.digital_inputs = held ? 8 : 0;
    permission.readSwitch(view);
  }
  RequestResult begin() { return permission.begin(view, conditions); }

  const SafetyInputs inputs{withSwitch()};
  GuidingPermission permission{inputs};
  SupervisorView view = fake::wellView(DriveLevel::Released);
  GuidingPermission::Conditions conditions{true, true, true};
};

TEST_F(Guiding, BeginsWithTheSwitchHeldAndGoesOnAsLongAsItIs) {
  ASSERT_EQ(begin(), RequestResult::Done);
  EXPECT_TRUE(permission.goesOn(view));
  hold(false);
  EXPECT_FALSE(permission.goesOn(view));
  EXPECT_EQ(permission.stop(), GuideStop::None);
}

TEST_F(Guiding, IsRefusedForEachThingThatIsMissing) {
  conditions.ready = false;
  EXPECT_EQ(begin(), RequestResult::NotReady);
  conditions.brakes_tested = false;
  EXPECT_EQ(begin(), RequestResult::BrakesUntested);
  conditions.has_guide = false;
  EXPECT_EQ(begin(), RequestResult::NoGuide);
  const SafetyInputs none{fake::hardware()};
  EXPECT_EQ(GuidingPermission(none).begin(view, {true, true, true}), RequestResult::NoEnablingSwitch);
}

TEST_F(Guiding, ASwitchThatIsHeldDownSinceTheDrivesWereEnabledBeginsNothing) {
  permission.driversEnabled();
  hold(true);
  EXPECT_EQ(begin(), RequestResult::SwitchNotReleased);
  hold(false);
  EXPECT_EQ(begin(), RequestResult::SwitchNotHeld);
  hold(true);
  EXPECT_EQ(begin(), RequestResult::Done);
}

TEST_F(Guiding, EveryGuidingWantsTheSwitchAnew) {
  ASSERT_EQ(begin(), RequestResult::Done);
  EXPECT_EQ(begin(), RequestResult::SwitchNotReleased);
}

TEST_F(Guiding, WithoutReadableInputsTheSwitchIsNotHeldAndWasNotReleased) {
  ASSERT_EQ(begin(), RequestResult::Done);
  view.unreadable = 1;
  hold(true);
  EXPECT_FALSE(permission.goesOn(view));
  hold(false);
  view.unreadable = 0;
  hold(true);
  EXPECT_EQ(begin(), RequestResult::SwitchNotReleased);
}

TEST_F(Guiding, SaysWhyHandGuideRefusedOrEndedIt) {
  view.guidance.stop = GuideStop::OutsideRange;
  EXPECT_EQ(begin(), RequestResult::GuideRefused);
  EXPECT_EQ(permission.stop(), GuideStop::OutsideRange);
  view.guidance.stop = GuideStop::None;
  ASSERT_EQ(begin(), RequestResult::Done);
  EXPECT_EQ(permission.stop(), GuideStop::None);
  view.guidance.stop = GuideStop::Wall;
  EXPECT_FALSE(permission.goesOn(view));
  EXPECT_EQ(permission.stop(), GuideStop::Wall);
}

TEST_F(Guiding, ASilentHandGuideEndsItAfterFiveCycles) {
  ASSERT_EQ(begin(), RequestResult::Done);
  view.unguided = 5;
  EXPECT_TRUE(permission.goesOn(view));
  view.unguided = 6;
  EXPECT_FALSE(permission.goesOn(view));
  EXPECT_EQ(permission.stop(), GuideStop::Silent);
}

}  // namespace
}  // namespace knee_robot::control
