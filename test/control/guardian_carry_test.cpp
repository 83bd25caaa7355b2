// What the drives give between a guardian's trip and 0 V.
#include <cmath>

#include "guarded_cards.h"

namespace knee_robot::control {
namespace {

using namespace guarded;

/// The same with a guardian that lets the drives carry for 30 ms.
class CarriedCards : public GuardedCards {
 protected:
  CarriedCards() {
    carrying_.configure();
    carrying_.start();
  }
  void cycleCarrying(int cycles = 1) {
    for (int i = 0; i < cycles; ++i) {
      testTime() += kMs;
      carrying_.update({testTime(), testTime(), kMs});
    }
  }
  void dies(double load_V) {
    hold(9.0);
    const std::array<double, hardware::kAxes> load = {load_V, -load_V, 0.5, 1.0};
    bus_.offerLoad(&load);
    cycleCarrying();
    hold(9.0);  // the guardian has to see it alive
    cycleCarrying(11);
  }
  Guardian carrying_{link_, *outputs_, 10 * kMs, kMs, testClock, {1, 4, 30 * kMs}};
};

TEST_F(CarriedCards, AreCarriedByWhatCarriedThemAtRestUntilTheBrakesHold) {
  dies(2.0);
  EXPECT_EQ(carrying_.report().trips.load(), 1u);
  EXPECT_EQ(image_.counter.outputs.load() & 3, 1) << "drives on, holding brakes ordered to engage";
  EXPECT_NEAR(volts(0), 2.0, 0.005);
  EXPECT_NEAR(volts(1), -2.0, 0.005);
  cycleCarrying(29);
  EXPECT_NEAR(volts(0), 2.0, 0.005);
  cycleCarrying(2);
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  for (std::size_t channel = 0; channel < hardware::kAxes; ++channel)
    EXPECT_EQ(volts(channel), 0.0);
}

TEST_F(CarriedCards, KeepAHeartbeatForTheRelayThatWouldTakeTheDrivesPower) {
  dies(2.0);
  for (int i = 0; i < 29; ++i) {
    const unsigned before = image_.counter.outputs.load();
    cycleCarrying();
    EXPECT_NE((before ^ image_.counter.outputs.load()) & 4u, 0u) << i;
  }
  cycleCarrying(2);
  EXPECT_EQ(image_.counter.outputs.load(), 0);
}

TEST_F(CarriedCards, HaveAGuardianThatSaysThatItActsUntilTheyAreDown) {
  EXPECT_FALSE(carrying_.report().acts.load());
  dies(2.0);
  EXPECT_TRUE(carrying_.report().acts.load()) << "ended now, it would leave the drives on";
  cycleCarrying(29);
  EXPECT_TRUE(carrying_.report().acts.load());
  cycleCarrying(2);
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  EXPECT_FALSE(carrying_.report().acts.load());
}

TEST_F(CarriedCards, AWriteThatWasUnderWayIsTakenBackWhileTheyAreCarried) {
  dies(2.0);
  cards_->writeVolts({9, 9, 9, 9}, written_);
  cards_->writeOutputs(3);
  cycleCarrying();
  EXPECT_EQ(image_.counter.outputs.load() & 3, 1);
  EXPECT_NEAR(volts(0), 2.0, 0.005);
}

TEST_F(CarriedCards, GoDownAtOnceWithoutALoadThatIsANumber) {
  dies(std::nan(""));
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  EXPECT_EQ(volts(0), 0.0);
}

TEST_F(CarriedCards, GoDownAtOnceWithALoadThatNoControllerCanHaveGiven) {
  dies(1e6);  // somebody has written over the link
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  EXPECT_EQ(volts(0), 0.0);
}

TEST_F(CarriedCards, GoDownAtOnceWhereNothingIsCarried) {
  hold(9.0);
  cycleCarrying();
  hold(9.0);
  bus_.offerLoad(nullptr);
  cycleCarrying(11);
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  EXPECT_EQ(volts(0), 0.0);
}

TEST_F(CarriedCards, AreNeverSwitchedOnByAGuardianThatStartsAndFindsADeadControllersLoad) {
  hold(9.0);
  const std::array<double, hardware::kAxes> load = {2.0, 2.0, 2.0, 2.0};
  bus_.offerLoad(&load);
  cards_->writeOutputs(0);                 // somebody has switched it off since
  link_.controller_pid.store(2147483646);  // no such process
  Guardian second(link_, *outputs_, 10 * kMs, kMs, testClock, {1, 4, 30 * kMs});
  second.configure();
  second.start();
  for (int i = 0; i < 60; ++i) {
    testTime() += kMs;
    second.update({testTime(), testTime(), kMs});
    ASSERT_EQ(image_.counter.outputs.load(), 0) << "cycle " << i;
    ASSERT_EQ(volts(0), 0.0) << "cycle " << i;
  }
  EXPECT_EQ(second.report().trips.load(), 1u);
}

TEST_F(CarriedCards, AreDownBeforeTheyAreGivenBack) {
  dies(2.0);
  bus_.writeOutputs(0);
  link_.reset_request.fetch_add(1);
  cycleCarrying();
  EXPECT_FALSE(bus_.isFencedOut());
  EXPECT_EQ(image_.counter.outputs.load(), 0);
  EXPECT_EQ(volts(0), 0.0);
}

}  // namespace
}  // namespace knee_robot::control
