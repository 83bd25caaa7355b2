// A counter card that loses its supply and comes back: its counts begin anew, and where its mode words are gone it
// counts nothing.
#include "holding_robot.h"

namespace knee_robot::control {
namespace {

using holding::HoldingRobot;

void comesBack(HoldingRobot& robot, bool with_modes) {
  simulation::Pci1784Image& card = robot.image.counter;
  const auto sums = simulation::publishedCounts(card);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    card.offsets[i].store(sums[i]);
    card.latched[i].store(0);
    if (!with_modes) card.modes[i].store(0);
  }
  card.outputs.store(0);
  card.disconnected.store(0);
}

/// Holds 60 mm above its home, where the counts of all axes are far from zero.
void climb(HoldingRobot& robot) {
  robot.play();
  robot.system->run(4.0);
  robot.system->stop();
  robot.system->run(1.0);
  ASSERT_EQ(robot.system->state(), MachineState::Holding);
}

TEST(LostCounterCard, IsUsedByNobodyBeforeTheControllerIsStartedAnewHoweverShortItWasGone) {
  for (const double gone_s : {0.001, 0.010, 2.0}) {
    for (const bool with_modes : {true, false}) {
      HoldingRobot robot;
      climb(robot);
      robot.image.counter.disconnected.store(with_modes ? simulation::kCardGone : simulation::kCardSilent);
      robot.system->run(gone_s);
      comesBack(robot, with_modes);
      robot.system->run(2.0);
      EXPECT_EQ(robot.image.status.brakes_engaged.load(), 0x0F) << "its outputs can be written again, and are";
      EXPECT_EQ(robot.image.status.drives_enabled.load(), 0);
      const Answer reset = robot.system->resetFaults();
      EXPECT_FALSE(reset.ok) << "after " << gone_s << " s: " << toString(robot.system->state());
      EXPECT_NE(reset.sentence.find("restart the controller and home again"), std::string::npos) << reset.sentence;
      EXPECT_FALSE(robot.system->enable().ok);
    }
  }
}

/// Its writes succeed: whoever believed them would take 0 V for safe behind brakes that nobody ordered.
TEST(LostCounterCard, ThatDoesNotAnswerIsHeldByWhatCarriedThePlatformAtRest) {
  for (const simulation::CardLoss loss : {simulation::kCardGone, simulation::kCardSilent}) {
    HoldingRobot robot;
    robot.system->run(5.0);
    const double height = robot.lowest = robot.plant.state().pose[1];
    robot.image.counter.disconnected.store(loss);
    robot.system->run(5.0);
    EXPECT_EQ(robot.system->state(), MachineState::SafeStopping) << int{loss};
    EXPECT_LT(height - robot.lowest, 0.001) << int{loss} << ": nobody has ordered the brakes";
    EXPECT_EQ(robot.image.status.brakes_engaged.load(), 0) << int{loss};
    const Answer refused = robot.system->shutdown();
    EXPECT_FALSE(refused.ok) << "0 V behind brakes that nobody ordered";
    EXPECT_NE(refused.sentence.find("support it"), std::string::npos) << refused.sentence;
    EXPECT_LT(height - robot.lowest, 0.001) << int{loss};
  }
}

/// Nobody sees the platform any more and no brake can be ordered; the model's weight where it was last seen, and what
/// was needed beside it at rest, hold it.
TEST(LostCounterCard, InMotionLeavesThePlatformAboutWhereItIs) {
  double deepest = 0.0;
  for (const double payload_kg : {0.0, 5.0}) {
    for (const bool swings : {true, false}) {
      for (const double time_s : {0.6, 0.8, 1.0, 1.2, 2.3}) {
        holding::Truth truth;
        truth.payload_kg = payload_kg;  // that nobody declared
        HoldingRobot robot(truth);
        robot.system->run(2.0);
        swings ? robot.swing() : robot.play(200);
        robot.system->run(time_s);
        const double height = robot.lowest = robot.plant.state().pose[1];
        robot.image.counter.disconnected.store(simulation::kCardGone);
        robot.system->run(3.0);
        deepest = std::max(deepest, height - robot.lowest);
      }
    }
  }
  std::printf("sinks by %.1f mm at most\n", 1e3 * deepest);
  EXPECT_LT(deepest, 0.01) << "once 1620 mm";
}

/// How far the platform gets from where it is, m, within 3 s without the counter card.
double leavesWithoutCard(HoldingRobot& robot) {
  const double height = robot.plant.state().pose[1];
  robot.image.counter.disconnected.store(simulation::kCardGone);
  double farthest = 0.0;
  for (int k = 0; k < 60; ++k) {
    robot.system->run(0.05);
    farthest = std::max(farthest, std::abs(robot.plant.state().pose[1] - height));
  }
  return farthest;
}

/// What the loop carried before the model did must not be carried by both.
TEST(LostCounterCard, JustAfterAPayloadOrAShareHasChangedLeavesThePlatformWhereItIs) {
  struct Change {
    double payload_kg;
    const char *property, *value;
  };
  for (const Change& change : {Change{15.0, "payload_kg", "15"},
                               {0.0, "payload_kg", "10"},
                               {15.0, "share_gravity", "0"},
                               {0.0, "share_gravity", "0.5"}}) {
    for (const double before_s : {0.02, 0.1, 0.3, 0.6, 2.0}) {
      holding::Truth truth;
      truth.payload_kg = change.payload_kg;
      HoldingRobot robot(truth);
      robot.system->run(5.0);
      ASSERT_TRUE(robot.system->setProperty("Feedforward", change.property, change.value).ok);
      robot.system->run(before_s);
      EXPECT_LT(leavesWithoutCard(robot), 0.002)
          << change.payload_kg << " kg, " << change.property << " " << change.value << " " << before_s << " s before";
    }
  }
}

TEST(LostCounterCard, InMotionJustAfterAPayloadOrAShareHasChangedIsAsWithoutTheChange) {
  const auto leaves = [](double payload_kg, const char* property, const char* value, double before_s) {
    holding::Truth truth;
    truth.payload_kg = payload_kg;
    HoldingRobot robot(truth);
    robot.system->run(2.0);
    robot.play(200);
    robot.system->run(1.5);
    if (*property != '\0') {
      EXPECT_TRUE(robot.system->setProperty("Feedforward", property, value).ok);
    }
    robot.system->run(before_s);
    return leavesWithoutCard(robot);
  };
  for (const double before_s : {0.05, 0.4, 1.0}) {
    const double empty = leaves(0.0, "", "", before_s), loaded = leaves(15.0, "", "", before_s);
    std::printf("without a change %.1f and %.1f mm\n", 1e3 * empty, 1e3 * loaded);
    EXPECT_LT(leaves(15.0, "payload_kg", "15", before_s), loaded + 0.005) << before_s;
    EXPECT_LT(leaves(0.0, "payload_kg", "10", before_s), empty + 0.005) << before_s;
    EXPECT_LT(leaves(0.0, "share_gravity", "0.5", before_s), empty + 0.005) << before_s;
  }
}

/// What nobody declared, and the weight that the Drivers' integrals carry where it is not fed forward, is known from
/// standing. An axis that stands for long creeps to where friction hides or adds its whole size.
TEST(LostCounterCard, InTheFirstStrokeLeavesThePlatformAboutWhereItIsHoweverLongItHasStood) {
  double farthest = 0.0;
  int cases = 0;
  for (const double stands_s : {0.0, 3.0, 12.0}) {
    for (const double share : {0.0, 0.6, 1.0}) {
      for (const double payload_kg : {0.0, 12.0, 17.5}) {
        for (const double time_s : {0.1, 0.3, 0.7}) {
          holding::Truth truth;
          truth.share_gravity = share;
          truth.payload_kg = payload_kg;
          truth.stands_s = stands_s;
          HoldingRobot robot(truth);
          robot.play(200);
          robot.system->run(time_s + (stands_s == 0.0 ? 0.35 : 0.0));  // the path begins by so much later
          const double leaves_m = leavesWithoutCard(robot);
          EXPECT_LT(leaves_m, 0.012) << stands_s << " s, " << share << ", " << payload_kg << " kg, " << time_s << " s";
          farthest = std::max(farthest, leaves_m);
          ++cases;
        }
      }
    }
  }
  std::printf("%d cases, at most %.1f mm\n", cases, 1e3 * farthest);
}

/// Other geometries, screws and frictions than those on which the sizes of what carries were chosen.
TEST(LostCounterCard, InMotionLeavesThePlatformOfTheOtherRobotsAboutWhereItIs) {
  for (const char* name : {"B", "final"}) {
    double farthest = 0.0;
    for (const double share : {0.0, 1.0}) {
      for (const double payload_kg : {0.0, 10.0}) {
        for (const double time_s : {0.3, 0.7, 1.2, 2.3}) {
          holding::Truth truth;
          truth.robot = name;
          truth.share_gravity = share;
          truth.payload_kg = payload_kg;
          HoldingRobot robot(truth);
          robot.play(200);
          robot.system->run(time_s);
          ASSERT_EQ(robot.system->state(), MachineState::Playing);
          farthest = std::max(farthest, leavesWithoutCard(robot));
        }
      }
    }
    std::printf("%s: at most %.1f mm\n", name, 1e3 * farthest);
    EXPECT_LT(farthest, 0.012) << name;
  }
}

/// Friction is not known yet at the highest speed of the first stroke, and turning changes what each axis carries.
TEST(LostCounterCard, AtTheHighestSpeedOfAFirstTurnLeavesThePlatformWhereItIsInMostCases) {
  int falls = 0, cases = 0;
  for (const double stands_s : {0.0, 3.0, 12.0}) {
    for (const double share : {0.0, 0.5, 1.0}) {
      for (const double payload_kg : {0.0, 5.0, 10.0, 15.0, 20.0}) {
        holding::Truth truth;
        truth.share_gravity = share;
        truth.payload_kg = payload_kg;
        truth.stands_s = stands_s;
        HoldingRobot robot(truth);
        robot.swing();
        robot.system->run(0.6 + (stands_s == 0.0 ? 0.35 : 0.0));
        falls += leavesWithoutCard(robot) > 0.012 ? 1 : 0;
        ++cases;
      }
    }
  }
  std::printf("%d of %d fall\n", falls, cases);
  EXPECT_LT(falls, cases / 4) << "nearly all before a mass was told from what stands";
}

/// Somebody leans on the platform, or gets off.
TEST(LostCounterCard, InAMovementSoonAfterTheLoadHasChangedAtRestLeavesThePlatformAboutWhereItIs) {
  for (const double push_N : {150.0, -100.0}) {
    for (const double before_s : {0.7, 2.0, 5.0}) {
      for (const double time_s : {0.3, 0.6, 1.5}) {
        HoldingRobot robot;
        robot.push(push_N);
        robot.system->run(before_s);
        robot.play(200);
        robot.system->run(time_s);
        EXPECT_LT(leavesWithoutCard(robot), 0.012) << push_N << " N, " << before_s << " s before, " << time_s << " s";
      }
    }
  }
}

/// "Release the emergency stop" helps nobody while brakes are open, or drives on, that nothing can be told any more.
TEST(LostCounterCard, IsSaidToBeLostWhateverBeganTheSafeStopInWhichItGoes) {
  for (const simulation::CardLoss loss : {simulation::kCardGone, simulation::kCardSilent}) {
    for (const double within_s : {0.02, 0.07, 0.15}) {
      HoldingRobot robot;
      ASSERT_TRUE(robot.system->emergencyStop().ok);
      robot.system->run(within_s);
      EXPECT_EQ(robot.system->status().fault_name, "emergency_stop");
      robot.image.counter.disconnected.store(loss);
      robot.system->run(2.0);
      EXPECT_EQ(robot.system->status().fault_name, "output_lost")
          << int{loss} << ", " << within_s << " s after the emergency stop: " << toString(robot.system->state())
          << ", drives " << int{robot.image.status.drives_enabled.load()} << ", brakes engaged "
          << int{robot.image.status.brakes_engaged.load()};
    }
  }
}

TEST(LostCounterCard, WhoseCountsBeginAnewBetweenTwoReadingsLeavesARobotThatDoesNotKnowWhereItIs) {
  HoldingRobot robot;
  climb(robot);
  comesBack(robot, true);
  robot.system->run(2.0);
  EXPECT_EQ(robot.system->status().fault_name, "encoder_jump");
  EXPECT_TRUE(robot.system->resetFaults().ok);
  const Answer enabled = robot.system->enable();
  EXPECT_FALSE(enabled.ok);
  EXPECT_NE(enabled.sentence.find("home the robot first"), std::string::npos) << enabled.sentence;
}

TEST(LostCounterCard, ThatLatchesNothingAnyMoreIsADeadEncoderAsSoonAsTheRobotMoves) {
  HoldingRobot robot;
  robot.play();
  robot.system->run(2.0);
  for (auto& mode : robot.image.counter.modes)
    mode.store(0);
  robot.system->run(2.0);
  EXPECT_EQ(robot.system->status().fault_name, "encoder_frozen");
  EXPECT_EQ(robot.image.status.brakes_engaged.load(), 0x0F);
}

}  // namespace
}  // namespace knee_robot::control
