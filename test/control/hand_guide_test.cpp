// A hand moves the platform: simulated hand on simulated robot A, the whole controller, stepped.
#include <functional>

#include "guided_robot.h"

namespace knee_robot::control {
namespace {

using namespace guided;

TEST(HandGuiding, LetsAHandMoveThePlatformAndPlaysItsPathAgain) {
  guided::Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.begin());
  rig.swing(1, 0.05, 0.03);
  rig.system->run(7.0);
  EXPECT_EQ(rig.system->state(), MachineState::Guiding) << rig.system->status().guiding;
  std::printf("farthest %.1f mm, hand at most %.0f N\n", 1e3 * rig.farthest, rig.strongest);
  EXPECT_GT(rig.farthest, 0.03) << "the hand is as soft as hands are";
  EXPECT_LT(rig.strongest, 60.0);
  const double guided = rig.farthest;
  rig.letGo();
  rig.hold(false);
  rig.system->run(0.5);
  EXPECT_EQ(rig.system->state(), MachineState::Holding);
  const std::string path = temporary("guided.txt");
  const Answer saved = rig.system->saveGuided(path);
  ASSERT_TRUE(saved.ok) << saved.sentence;
  const trajectory::Reference reference = trajectory::readReference(path);
  std::remove(path.c_str());
  ASSERT_TRUE(rig.system->loadReference(reference).ok);
  ASSERT_TRUE(rig.system->approach().ok);
  ASSERT_TRUE(rig.system->waitFor(MachineState::Holding, 20.0));
  rig.watch();
  ASSERT_TRUE(rig.system->play().ok);
  ASSERT_TRUE(rig.system->waitFor(MachineState::Holding, 60.0)) << rig.system->status().fault_sentence;
  EXPECT_NEAR(rig.farthest, guided, 0.003) << "as far as the hand went";
}

TEST(HandGuiding, HoldsWhereThePlatformIsWhenTheSwitchIsLetGoOfWhateverTheHandDoes) {
  guided::Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.begin());
  rig.swing(1, 0.06, 0.04);
  rig.system->run(1.6);
  const double speed = rig.plant.state().pose_velocity.head<2>().norm();
  EXPECT_GT(speed, 0.02);
  rig.hold(false);
  rig.watch();
  rig.system->run(1.0);  // the hand goes on pulling
  EXPECT_EQ(rig.system->state(), MachineState::Holding);
  std::printf("from %.0f mm/s: %.2f mm on, with the hand pulling with %.0f N\n", 1e3 * speed, 1e3 * rig.farthest,
              rig.strongest);
  EXPECT_LT(rig.farthest, 0.004);
  rig.system->run(1.0);
  rig.hold(true);
  rig.system->run(0.1);
  EXPECT_EQ(rig.system->state(), MachineState::Holding) << "taking hold again begins nothing";
}

TEST(HandGuiding, IsRefusedWithoutModelSwitchOrTestedBrakesAndUnlessTheSwitchIsTakenAnew) {
  const auto refusal = [](const Machine& setup, bool held) {
    guided::Rig rig(setup);
    EXPECT_TRUE(rig.system->start().ok);
    EXPECT_TRUE(rig.system->enable().ok);
    rig.system->run(0.3);
    rig.hold(held);
    rig.system->run(0.1);
    const Answer answer = rig.system->guide();
    EXPECT_FALSE(answer.ok);
    rig.system->run(0.1);
    EXPECT_EQ(rig.system->state(), MachineState::Holding);
    return answer.sentence;
  };
  Machine setup;
  EXPECT_NE(refusal(setup, false).find("not held"), std::string::npos);
  setup.model = false;
  EXPECT_NE(refusal(setup, true).find("no identified model"), std::string::npos);
  setup = Machine{};
  setup.enabling_switch = false;
  EXPECT_NE(refusal(setup, true).find("no enabling switch"), std::string::npos);
  setup = Machine{};
  setup.brakes = false;
  EXPECT_NE(refusal(setup, true).find("brakes are not tested"), std::string::npos);
  guided::Rig rig;
  rig.hold(true);  // tied down before the robot is enabled
  ASSERT_TRUE(rig.system->start().ok);
  EXPECT_FALSE(rig.system->guide().ok) << "disabled";
  ASSERT_TRUE(rig.system->enable().ok);
  EXPECT_NE(rig.system->guide().sentence.find("release the enabling switch first"), std::string::npos);
  EXPECT_FALSE(rig.system->saveGuided(temporary("none.txt")).ok);
}

TEST(HandGuiding, PushesBackAtTheEndOfTheRangeAndHoldsThere) {
  guided::Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.begin());
  rig.swing(1, 0.8, 0.04);
  for (int k = 0; k < 300 && rig.system->state() == MachineState::Guiding; ++k)
    rig.system->run(0.1);
  EXPECT_EQ(rig.system->state(), MachineState::Holding) << rig.system->status().fault_sentence;
  EXPECT_NE(rig.system->status().guiding.find("limit"), std::string::npos) << rig.system->status().guiding;
  rig.system->run(0.5);
  trajectory::Reference here;
  here.points.resize(1, 4);
  here.points.row(0) = rig.plant.lengths().transpose();
  EXPECT_TRUE(trajectory::checkReference(here, rig.robot).ok()) << "still within what may be played";
  std::printf("held after %.0f mm, hand at most %.0f N\n", 1e3 * rig.farthest, rig.strongest);
  rig.letGo();
  rig.hold(false);
  rig.system->run(0.1);
  rig.hold(true);
  rig.system->run(0.1);
  const Answer again = rig.system->guide();
  ASSERT_TRUE(again.ok) << again.sentence;
  rig.system->run(0.8);
  rig.watch();
  rig.swing(1, -0.05, 0.03);
  rig.system->run(3.0);
  EXPECT_EQ(rig.system->state(), MachineState::Guiding)
      << "a hand may lead it away from there: " << rig.system->status().guiding;
  EXPECT_GT(rig.farthest, 0.01);
}

TEST(HandGuiding, KeepsThePatientsRangeAndSpeedAndSavesAPathWithinThem) {
  guided::Rig rig;
  const Pose home = rig.plant.state().pose;
  const std::string patient = temporary("guided_patient.yaml");
  char text[300];
  std::snprintf(
      text, sizeof text,
      "patient: \"1\"\npose: {X_m: [%.3f, %.3f], Z_m: [%.3f, %.3f], theta_deg: [-20, 20], psi_deg: [-20, 20]}\n",
      home[0] - 0.05, home[0] + 0.05, home[1] - 0.02, home[1] + 0.05);
  writeFileAtomically(patient, text);
  ASSERT_NO_FATAL_FAILURE(rig.begin(patient));
  std::remove(patient.c_str());
  rig.swing(1, 0.2, 0.03);
  for (int k = 0; k < 200 && rig.system->state() == MachineState::Guiding; ++k)
    rig.system->run(0.1);
  EXPECT_EQ(rig.system->state(), MachineState::Holding) << rig.system->status().fault_sentence;
  rig.letGo();
  rig.system->run(0.5);
  EXPECT_EQ(rig.system->status().fault_name, "");
  EXPECT_LT(rig.plant.state().pose[1], home[1] + 0.05);
  std::printf("held %.1f mm before the patient's limit, at most %.1f mm/s\n",
              1e3 * (home[1] + 0.05 - rig.plant.state().pose[1]), 1e3 * rig.fastest);
  EXPECT_GT(rig.plant.state().pose[1], home[1] + 0.035);
  EXPECT_LT(rig.fastest, 0.03) << "1.5 times the patient's 20 mm/s";
  const std::string path = temporary("guided_within.txt");
  const Answer saved = rig.system->saveGuided(path);
  ASSERT_TRUE(saved.ok) << saved.sentence;
  EXPECT_TRUE(rig.system->loadReference(trajectory::readReference(path)).ok);
  std::remove(path.c_str());
}

TEST(HandGuiding, BrakesAHandThatIsTooFast) {
  guided::Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.begin());
  rig.swing(1, 0.08, 0.2);  // four times the limit of 0.05 m/s
  rig.system->run(3.0);
  std::printf("at most %.0f mm/s, hand at most %.0f N\n", 1e3 * rig.fastest, rig.strongest);
  EXPECT_LT(rig.fastest, 0.075);
}

TEST(HandGuiding, DoesNotLetAWrongPayloadDrift) {
  for (const double payload_kg : {1.0, 2.0, 3.0, 5.0, 6.0}) {
    Machine setup;
    setup.payload_kg = payload_kg;  // nobody declared it
    guided::Rig rig(setup);
    ASSERT_NO_FATAL_FAILURE(rig.begin());
    rig.system->run(5.0);
    std::printf("%.0f kg: %.2f mm in 5 s\n", payload_kg, 1e3 * rig.farthest);
    EXPECT_LT(rig.farthest, 0.002);
    EXPECT_LT(rig.fastest, 0.02) << "in the moment in which an encoder is asked";
  }
}

TEST(HandGuiding, DoesNotRunAwayFromAHandThatLeanedOnThePlatformWhileItWasWeighedAndLetsGo) {
  for (const int coordinate : {0, 1}) {
    for (const double newton : {-100.0, -60.0, -30.0, 30.0, 60.0, 100.0}) {
      guided::Rig rig;
      ASSERT_NO_FATAL_FAILURE(rig.beginLeaningOn(coordinate, newton / 2000.0));
      rig.system->run(15.0);
      EXPECT_LT(rig.farthest, 0.005) << newton << " N in coordinate " << coordinate;
      std::printf("coordinate %d, %4.0f N: %.1f mm in 15 s, %s %s\n", coordinate, newton, 1e3 * rig.farthest,
                  toString(rig.system->state()), rig.system->status().fault_name.c_str());
    }
  }
}

TEST(HandGuiding, EndsWhenTheWeightIsNotFedForwardAnyMore) {
  guided::Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.begin());
  ASSERT_TRUE(rig.system->setProperty("Feedforward", "share_gravity", "0").ok);
  rig.system->run(1.0);
  EXPECT_EQ(rig.system->state(), MachineState::Holding);
  EXPECT_NE(rig.system->status().guiding.find("declare it"), std::string::npos) << rig.system->status().guiding;
  EXPECT_LT(rig.farthest, 0.002);
}

TEST(HandGuiding, EndsWhereMuchMoreThanDeclaredRestsOnThePlatform) {
  Machine setup;
  setup.payload_kg = 25.0;
  guided::Rig rig(setup);
  ASSERT_TRUE(rig.system->start().ok);
  ASSERT_TRUE(rig.system->enable().ok);
  rig.system->run(1.0);
  rig.hold(true);
  rig.system->run(0.05);
  rig.watch();
  ASSERT_TRUE(rig.system->guide().ok);
  rig.system->run(1.0);
  EXPECT_EQ(rig.system->state(), MachineState::Holding);
  EXPECT_NE(rig.system->status().guiding.find("declare it"), std::string::npos) << rig.system->status().guiding;
  EXPECT_LT(rig.farthest, 0.003);
}

TEST(HandGuiding, StaysStillWithFrictionThatIsSmallerThanIdentified) {
  Machine setup;
  setup.coulomb_scale = 0.8;
  guided::Rig rig(setup);
  ASSERT_NO_FATAL_FAILURE(rig.begin());
  rig.system->run(3.0);
  std::printf("%.2f mm in 3 s\n", 1e3 * rig.farthest);
  EXPECT_LT(rig.farthest, 0.002);
}

TEST(HandGuiding, DoesNotRunAwayOnceItIsKnownThatFrictionHasBecomeLess) {
  for (const double scale : {0.7, 0.6, 0.5, 0.3}) {
    Machine setup;
    setup.coulomb_scale = scale;
    setup.played = true;
    guided::Rig rig(setup);
    ASSERT_NO_FATAL_FAILURE(rig.begin());
    rig.system->run(5.0);
    std::printf("%.0f %% of the friction: %.1f mm in 5 s\n", 1e2 * scale, 1e3 * rig.farthest);
    EXPECT_EQ(rig.system->state(), MachineState::Guiding) << rig.system->status().guiding;
    EXPECT_LT(rig.farthest, 0.003);  // once up to 138 mm
  }
}

TEST(HandGuiding, IsNoFrictionThatHasBecomeLessAndNoModelThatDoesNotHold) {
  guided::Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.begin());
  const Pose home = rig.plant.state().pose;
  const double start = rig.plant.time();
  rig.wanted = [=](double t) {
    Pose pose = home;
    pose[0] += 0.02 * std::sin(0.4 * M_PI * (t - start));
    return pose;
  };
  for (int k = 0; k < 250; ++k) {
    rig.system->run(0.1);
    const Disturbance now = *rig.system->disturbance();
    ASSERT_TRUE(now.model_holds) << "after " << 0.1 * k << " s of a hand; once after 20 s";
    ASSERT_EQ(now.friction_growth, AxisValues{}) << "after " << 0.1 * k << " s";
  }
  EXPECT_EQ(rig.system->state(), MachineState::Guiding) << rig.system->status().guiding;
}

TEST(HandGuiding, EndsInTheSameSafeStopWhateverFails) {
  struct Case {
    const char* what;
    std::function<void(guided::Rig&)> breaks;
  };
  const Case cases[] = {
      {"emergency stop", [](guided::Rig& rig) { rig.image.surroundings.emergency_stop_pressed.store(1); }},
      {"encoder cable",
       [](guided::Rig& rig) {
         rig.image.faults.encoder[1].store(static_cast<std::uint8_t>(simulation::EncoderFault::Disconnected));
       }},
      {"frozen encoder",
       [](guided::Rig& rig) {
         rig.image.faults.encoder[1].store(static_cast<std::uint8_t>(simulation::EncoderFault::Frozen));
       }},
      {"counter card", [](guided::Rig& rig) { rig.image.counter.disconnected.store(1); }},
      {"drive", [](guided::Rig& rig) { rig.image.faults.drive_dead.store(2); }},
  };
  for (const Case& one : cases) {
    guided::Rig rig;
    ASSERT_NO_FATAL_FAILURE(rig.begin());
    rig.swing(1, 0.08, 0.03);
    rig.system->run(1.5);
    ASSERT_EQ(rig.system->state(), MachineState::Guiding);
    const double height = rig.plant.state().pose[1];
    one.breaks(rig);
    double lowest = height;
    for (int k = 0; k < 3000 && rig.system->state() == MachineState::Guiding; ++k) {
      rig.system->step();
      lowest = std::min(lowest, rig.plant.state().pose[1]);
    }
    rig.letGo();
    rig.hold(false);
    rig.system->run(1.5);
    lowest = std::min(lowest, rig.plant.state().pose[1]);
    std::printf("%-16s %-10s %s, %.1f mm below\n", one.what, toString(rig.system->state()),
                rig.system->status().fault_name.c_str(), 1e3 * (height - lowest));
    EXPECT_NE(rig.system->state(), MachineState::Guiding) << one.what;
    EXPECT_LT(height - lowest, 0.03) << one.what;
  }
}

TEST(HandGuiding, StopAndDisableEndItAsEver) {
  guided::Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.begin());
  EXPECT_FALSE(rig.system->play().ok);
  ASSERT_TRUE(rig.system->stop().ok);
  rig.system->run(0.1);
  EXPECT_EQ(rig.system->state(), MachineState::Holding);
  rig.hold(false);
  rig.system->run(0.1);
  rig.hold(true);
  rig.system->run(0.1);
  ASSERT_TRUE(rig.system->guide().ok);
  rig.system->run(0.8);
  ASSERT_TRUE(rig.system->disable().ok);
  EXPECT_EQ(rig.system->state(), MachineState::Disabled);
}

}  // namespace
}  // namespace knee_robot::control
