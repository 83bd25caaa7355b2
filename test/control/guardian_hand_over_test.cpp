// What becomes of the platform when the controller dies: the guardian hands the load over to the brakes, and watches.
#include "guarded_robot.h"
#include "knee_robot/base/files.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

using namespace guarded;

TEST(AControllerThatDies, IsCarriedUntilBrakesThatEngageLateHold) {
  for (const bool watches : {false, true}) {
    double deepest = 0.0, farthest = 0.0, longest = 0.0;
    for (const std::uint8_t late : {1, 2, 4, 8, 15}) {
      Guarded robot(watches);
      robot.image.faults.hold_late.store(late);
      const AfterDeath after = robot.dies();
      deepest = std::max(deepest, after.drop_m);
      farthest = std::max(farthest, after.leg_m);
      longest = std::max(longest, after.on_s);
      if (!watches) continue;
      EXPECT_LT(after.drop_m, 0.01) << "once 10 to 170 mm, brakes " << static_cast<int>(late);
      EXPECT_LT(after.on_s, 1.2);
      EXPECT_NE(after.slipped, 0);
    }
    std::printf("%s: a leg goes %.1f mm, the platform sinks by %.1f mm, drives on for %.2f s\n",
                watches ? "watched" : "for the brakes' time", 1e3 * farthest, 1e3 * deepest, longest);
  }
}

/// No brake can be ordered: 0 V would let the platform fall by its whole stroke.
TEST(AControllerThatDies, IsCarriedAsLongAsTheCounterCardIsGone) {
  for (const simulation::CardLoss loss : {simulation::kCardGone, simulation::kCardSilent}) {
    for (const bool before : {true, false}) {
      Guarded robot(true);
      const auto drops_m_in = [&](double seconds) {
        const double height = robot.plant.state().pose[1];
        double deepest = height;
        for (int k = 0; k < static_cast<int>(1000.0 * seconds); ++k) {
          robot.step();
          deepest = std::min(deepest, robot.plant.state().pose[1]);
        }
        return height - deepest;
      };
      robot.system->run(4.0);         // until what carries at rest is known
      if (!before) drops_m_in(0.02);  // the guardian carries already
      robot.image.counter.disconnected.store(loss);
      if (before) robot.system->run(0.5);
      const double drop_m = drops_m_in(3.0);
      EXPECT_LT(drop_m, 0.01) << int{loss} << (before ? " before" : " after") << ": once 420 mm";
      EXPECT_EQ(robot.guardian->report().written.load(), !before);
      EXPECT_TRUE(robot.guardian->report().acts.load());
      robot.image.counter.disconnected.store(0);
      const AfterDeath after = robot.dies();
      EXPECT_LT(after.drop_m, 0.005) << "the card is back: its brakes engage";
      EXPECT_LT(after.on_s, 1.2);
      std::printf("sinks by %.1f mm in 3 s, then by %.1f mm\n", 1e3 * drop_m, 1e3 * after.drop_m);
    }
  }
}

/// What the controller held it with, told from friction, the guardian holds it with.
TEST(AControllerThatDies, IsCarriedWhereTheCounterCardWentInMotion) {
  double farthest = 0.0;
  for (const double time_s : {0.3, 0.9, 1.6}) {
    for (const double before_s : {0.02, 0.1, 0.5}) {
      Guarded robot(true);
      robot.swing();
      robot.system->run(time_s);
      const double height = robot.plant.state().pose[1];
      robot.image.counter.disconnected.store(simulation::kCardGone);
      robot.system->run(before_s);
      for (int k = 0; k < 3000; ++k) {
        robot.step();
        farthest = std::max(farthest, std::abs(robot.plant.state().pose[1] - height));
      }
      EXPECT_TRUE(robot.guardian->report().acts.load()) << time_s << ", " << before_s;
    }
  }
  std::printf("goes %.1f mm up or down at most\n", 1e3 * farthest);
  EXPECT_LT(farthest, 0.012);
}

/// The model of this deployment weighs nothing: what stands on the drives counts as a mass on the platform.
TEST(AControllerThatDies, IsCarriedWithoutAModelsWeightToo) {
  const TemporaryFolder folder;
  const std::string known = "type: ModelFeedforward, ", deployment = folder + "/deployment.yaml";
  std::string text = readFile(holding::file("config/deployment/simulation.yaml"));
  ASSERT_NE(text.find(known), std::string::npos);
  text.insert(text.find(known) + known.size(), "properties: {largest_share: 0}, ");
  writeFileAtomically(deployment, text);
  double farthest = 0.0;
  for (const double time_s : {0.9, 1.2, 1.6, 2.0}) {  // in the first stroke it may fall
    Guarded robot(true, deployment);
    robot.swing();
    robot.system->run(time_s);
    const double height = robot.plant.state().pose[1];
    robot.image.counter.disconnected.store(simulation::kCardGone);
    robot.system->run(0.1);
    for (int k = 0; k < 3000; ++k) {
      robot.step();
      farthest = std::max(farthest, std::abs(robot.plant.state().pose[1] - height));
    }
  }
  std::printf("goes %.1f mm up or down at most\n", 1e3 * farthest);
  EXPECT_LT(farthest, 0.012) << "once to 0 V";
}

TEST(AControllerThatDies, InTheMiddleOfAMotionIsCarriedToRest) {
  double deepest = 0.0;
  for (const std::uint8_t late : {0, 1, 4, 8, 15}) {
    for (const double time_s : {0.5, 0.9, 1.3}) {
      Guarded robot(true);
      robot.swing();
      robot.system->run(time_s);
      robot.image.faults.hold_late.store(late);
      const AfterDeath after = robot.dies();
      deepest = std::max(deepest, after.drop_m);
      EXPECT_LT(after.on_s, 1.2) << static_cast<int>(late);
      if (late == 0) {
        EXPECT_LT(after.on_s, 0.5);
      }
    }
  }
  std::printf("the platform sinks by %.1f mm at most\n", 1e3 * deepest);
  EXPECT_LT(deepest, 0.04) << "once 129 mm";
}

TEST(AControllerThatDies, HasItsDrivesOffSoonWhereTheBrakesHold) {
  Guarded robot(true);
  const AfterDeath after = robot.dies();
  EXPECT_EQ(after.slipped, 0);
  EXPECT_LT(after.drop_m, 0.001);
  EXPECT_NEAR(after.on_s, 0.01 + 0.03 + 0.38, 0.005);
}

TEST(AControllerThatDies, LeavesNothingOnForEverWhereNoBrakeEngages) {
  Guarded robot(true);
  robot.image.faults.hold_open.store(15);
  const AfterDeath after = robot.dies();
  std::printf("on for %.2f s, a leg goes %.1f mm\n", after.on_s, 1e3 * after.leg_m);
  EXPECT_LT(after.on_s, 2.2);
  EXPECT_NE(after.slipped, 0);
}

}  // namespace
}  // namespace knee_robot::control
