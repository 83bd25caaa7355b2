// Who is on the robot: nothing moves before somebody has said it, a patient stays over a restart, and a machine that is
// not fit to carry one is refused sentence by sentence.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/files.h"
#include "knee_robot/control/control_system.h"
#include "knee_robot/simulation/robot_simulation.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

constexpr double kPlantStep = 0.001;  // s
const std::string kConfig = std::string(KNEE_SOURCE_DIR) + "/config";
const char* const kPatient = R"(patient: "17"
pose: {X_m: [-0.1, 0.1], Z_m: [0.58, 0.68], theta_deg: [-10, 10], psi_deg: [-10, 10]}
speed: {linear_mm_per_s: 40, angular_deg_per_s: 4}
)";

class Occupancies : public ::testing::Test {
 protected:
  void SetUp() override {
    patient = folder + "/p17.yaml";
    writeFileAtomically(patient, kPatient);
  }

  /// A controller on the simulated robot, as one start of the process.
  struct Controller {
    Controller(const std::string& memory, bool empty, const std::string& backend = "simulated", const char* name = "A")
        : robot(mechanism::loadRobot(kConfig + "/robots/" + name + ".yaml")),
          plant(robot, dynamics::loadRobotInertia(robot),
                simulation::loadSimulationParameters(kConfig + "/simulation/" + name + ".yaml"), image),
          bus(simulation::openImageCards(image)),
          hardware(loadHardwareFile(kConfig + "/hardware/simulated.yaml")) {
      hardware.backend = backend;
      ControlSystem::Options options;
      options.execution = rt::Execution::Stepped;
      options.empty = empty;
      options.patient_memory = memory;
      const mechanism::Lengths start = plant.lengths();
      options.lengths_at_start_m = AxisValues{start[0], start[1], start[2], start[3]};
      system.emplace(robot, hardware, kConfig + "/deployment/simulation.yaml", *bus, options);
      system->setPlant([this](rt::Nanoseconds time) {
        while (plant.time() + 0.5 * kPlantStep < rt::toSeconds(time))
          plant.step(kPlantStep);
      });
      const Answer started = system->start();
      EXPECT_TRUE(started.ok) << started.sentence;
    }
    const mechanism::Robot robot;
    simulation::RobotImage image;
    simulation::RobotSimulation plant;
    std::unique_ptr<hardware::AxisBus> bus;
    HardwareFile hardware;
    std::optional<ControlSystem> system;
  };

  std::string memory() const { return folder + "/patient.txt"; }
  const TemporaryFolder folder;
  std::string patient;
};

TEST_F(Occupancies, NothingMovesBeforeSomebodyHasSaidWhoIsOnTheRobot) {
  Controller controller(memory(), false);
  const Answer refused = controller.system->enable();
  EXPECT_FALSE(refused.ok);
  EXPECT_NE(refused.sentence.find("declare_empty"), std::string::npos) << refused.sentence;
  EXPECT_EQ(controller.system->state(), MachineState::Disabled);
  ASSERT_TRUE(controller.system->declareEmpty().ok);
  EXPECT_TRUE(controller.system->enable().ok);
}

TEST_F(Occupancies, NobodyIsLetOnARobotWhoseGainsSomebodyTriedOutAndForgot) {
  Controller controller(memory(), true);
  ASSERT_TRUE(controller.system->setProperty("Driver4", "proportional_N_per_m", "8").ok);
  ASSERT_TRUE(controller.system->setProperty("Feedforward", "payload_kg", "12").ok) << "the patient's own";
  const Answer refused = controller.system->loadPatient(patient);
  EXPECT_FALSE(refused.ok);
  EXPECT_NE(refused.sentence.find("Driver4.proportional_N_per_m is 8 and was 60000"), std::string::npos)
      << refused.sentence;
  EXPECT_EQ(refused.sentence.find("payload"), std::string::npos) << refused.sentence;
  ASSERT_TRUE(controller.system->setProperty("Driver4", "proportional_N_per_m", "60000").ok);
  const Answer loaded = controller.system->loadPatient(patient);
  EXPECT_TRUE(loaded.ok) << loaded.sentence;
}

/// The platform turns by 12 deg and stays there: 2 deg more than the patient may.
trajectory::Reference turning() {
  trajectory::Reference reference;
  reference.name = "turning.txt";
  reference.space = trajectory::Space::Platform;
  reference.points.resize(2001, 4);
  for (Eigen::Index k = 0; k <= 2000; ++k) {
    const double x = static_cast<double>(k) / 2000.0;
    reference.points.row(k) << 0.0, 0.65, 12.0 / kDegrees * x * x * x * (10.0 + x * (6.0 * x - 15.0)), 0.0;
  }
  return reference;
}

TEST_F(Occupancies, WhatWasCheckedBeforeThePatientCameIsNotLoadedBesideHim) {
  Controller controller(memory(), true);
  const PlayableReference playable = controller.system->check(turning());
  EXPECT_EQ(controller.system->whyNotForPatient(playable), "");
  EXPECT_TRUE(controller.system->loadReference(playable).ok);
  ASSERT_TRUE(controller.system->loadPatient(patient).ok);
  EXPECT_EQ(controller.system->status().reference, "") << "forgotten";
  const Answer refused = controller.system->loadReference(playable);
  EXPECT_FALSE(refused.ok);
  EXPECT_NE(refused.sentence.find("outside the patient's -10 .. 10"), std::string::npos) << refused.sentence;
  EXPECT_EQ(controller.system->status().reference, "");
  EXPECT_EQ(controller.system->whyNotForPatient(playable), refused.sentence);
}

TEST_F(Occupancies, WhatWasAskedForBeforeThePatientCameMovesNothing) {
  Controller controller(memory(), true);
  const std::uint64_t asked = controller.system->halts();
  ASSERT_TRUE(controller.system->loadPatient(patient).ok);
  const Answer refused = controller.system->enable(asked);
  EXPECT_FALSE(refused.ok);
  EXPECT_NE(refused.sentence.find("changed who is on it"), std::string::npos) << refused.sentence;
  EXPECT_TRUE(controller.system->enable().ok);
}

TEST_F(Occupancies, ThePayloadOfAPatientGoesWithHim) {
  Controller controller(memory(), true);
  ControlSystem& system = *controller.system;
  ASSERT_TRUE(system.setProperty("Feedforward", "payload_kg", "25").ok);
  ASSERT_TRUE(system.loadPatient(patient).ok);
  ASSERT_TRUE(system.clearPatient().ok);
  ASSERT_TRUE(system.declareEmpty().ok);
  const double stood = controller.plant.state().pose[1];
  ASSERT_TRUE(system.enable().ok);
  double highest = stood;
  for (int k = 0; k < 1000; ++k) {
    system.step();
    highest = std::max(highest, controller.plant.state().pose[1]);
  }
  EXPECT_LT(highest - stood, 0.0005) << "the platform jumps up by " << 1e3 * (highest - stood) << " mm";
}

TEST_F(Occupancies, APatientStaysOverARestartWhateverTheCommandLineSays) {
  {
    Controller controller(memory(), true);
    const Answer loaded = controller.system->loadPatient(patient);
    ASSERT_TRUE(loaded.ok) << loaded.sentence;
  }
  Controller again(memory(), true);
  EXPECT_EQ(again.system->status().occupancy, Occupancy::Patient);
  EXPECT_EQ(again.system->status().patient, "17");
}

TEST_F(Occupancies, ARestartWithoutThePatientsFileMovesNothingAndSaysWhy) {
  {
    Controller controller(memory(), true);
    ASSERT_TRUE(controller.system->loadPatient(patient).ok);
  }
  std::filesystem::remove(patient);
  Controller again(memory(), true);
  const Answer refused = again.system->enable();
  EXPECT_FALSE(refused.ok);
  EXPECT_NE(refused.sentence.find("p17.yaml"), std::string::npos) << refused.sentence;
}

TEST_F(Occupancies, APatientsFileThatHasChangedMeanwhileMovesNothingUntilItIsLoadedAgain) {
  {
    Controller controller(memory(), true);
    ASSERT_TRUE(controller.system->loadPatient(patient).ok);
  }
  {
    std::ofstream(patient, std::ios::app) << "# wider, by somebody\n";
    Controller again(memory(), true);
    const Answer refused = again.system->enable();
    EXPECT_FALSE(refused.ok);
    EXPECT_NE(refused.sentence.find("is not what it was"), std::string::npos) << refused.sentence;
    ASSERT_TRUE(again.system->loadPatient(patient).ok);
  }
  EXPECT_EQ(Controller(memory(), true).system->status().patient, "17");
}

TEST_F(Occupancies, ClearingThePatientLeavesARobotThatDoesNotMoveNowAndAfterARestart) {
  {
    Controller controller(memory(), true);
    ASSERT_TRUE(controller.system->loadPatient(patient).ok);
    ASSERT_TRUE(controller.system->clearPatient().ok);
    EXPECT_FALSE(controller.system->enable().ok);
  }
  Controller again(memory(), false);
  EXPECT_FALSE(again.system->enable().ok);
}

TEST_F(Occupancies, NeitherClearedNorChangedWhileTheDrivesAreOnOrAFaultIsLatched) {
  Controller controller(memory(), true);
  ASSERT_TRUE(controller.system->loadPatient(patient).ok);
  ASSERT_TRUE(controller.system->enable().ok);
  EXPECT_FALSE(controller.system->clearPatient().ok);
  EXPECT_FALSE(controller.system->declareEmpty().ok);
  ASSERT_TRUE(controller.system->emergencyStop().ok);
  ASSERT_TRUE(controller.system->waitFor(MachineState::Faulted, 5.0));
  EXPECT_FALSE(controller.system->clearPatient().ok);
  EXPECT_EQ(controller.system->status().patient, "17");
}

TEST_F(Occupancies, AMemoryThatCannotBeWrittenRefusesThePatientAndKeepsWhoWasThere) {
  const std::string there = folder + "/memory";
  Controller controller(there + "/patient.txt", true);
  std::filesystem::remove_all(there);
  writeFileAtomically(there, "no folder\n");
  const Answer refused = controller.system->loadPatient(patient);
  EXPECT_FALSE(refused.ok);
  EXPECT_NE(refused.sentence.find("cannot be remembered"), std::string::npos) << refused.sentence;
  EXPECT_EQ(controller.system->status().occupancy, Occupancy::Empty);
}

TEST_F(Occupancies, AMemoryThatCannotBeReadMovesNothingWhateverTheCommandLineSays) {
  writeFileAtomically(folder + "/memory", "no folder\n");
  Controller controller(folder + "/memory/patient.txt", true);
  const Answer refused = controller.system->enable();
  EXPECT_FALSE(refused.ok);
  EXPECT_NE(refused.sentence.find("cannot be remembered"), std::string::npos) << refused.sentence;
}

TEST_F(Occupancies, ARealRobotWithoutGuardianForceLimitsAndMarginIsRefusedSentenceBySentence) {
  Controller controller(memory(), true, "pci");
  const Answer refused = controller.system->loadPatient(patient);
  EXPECT_FALSE(refused.ok);
  for (const char* part : {"guardian", "force limits", "singularity margin"})
    EXPECT_NE(refused.sentence.find(part), std::string::npos) << part << ": " << refused.sentence;
  EXPECT_EQ(controller.system->status().occupancy, Occupancy::Empty);
}

TEST_F(Occupancies, NoGainMovesFarFromWhatItWasWhenThePatientWasLoadedHoweverManySteps) {
  Controller controller(memory(), true);
  ASSERT_TRUE(controller.system->loadPatient(patient).ok);
  double gain = 0.0;
  for (const rt::PropertyReport& one : controller.system->properties()) {
    if (one.component == "Driver4" && one.name == "proportional_N_per_m") gain = std::stod(one.value);
  }
  ASSERT_GT(gain, 0.0);
  const auto set = [&](double share) {
    return controller.system->setProperty("Driver4", "proportional_N_per_m", std::to_string(share * gain)).ok;
  };
  EXPECT_TRUE(set(1.1));
  EXPECT_TRUE(set(1.19));
  EXPECT_FALSE(set(1.3)) << "30 % from where it was, though 9 % from where it is";
  EXPECT_FALSE(controller.system->setProperty("Driver4", "proportional_N_per_m", "nan").ok);
}

}  // namespace
}  // namespace knee_robot::control
