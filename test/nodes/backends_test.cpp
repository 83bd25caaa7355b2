// One table opens the machine for controller and guardian.
#include "../../src/nodes/backends.h"

#include <gtest/gtest.h>

#include <string>

#include "knee_robot/base/errors.h"

namespace knee_robot::nodes {
namespace {

TEST(Backends, AreThoseThatHardwareFilesMayName) {
  ASSERT_EQ(backends().size(), control::kBackends.size());
  for (const char* name : control::kBackends) {
    bool found = false;
    for (const Backend& backend : backends())
      found = found || std::string(backend.name) == name;
    EXPECT_TRUE(found) << name;
  }
}

TEST(Backends, ThatAreNotThereAreRefusedInASentenceByControllerAndGuardianAlike) {
  const mechanism::Robot robot = mechanism::loadRobot(KNEE_SOURCE_DIR "/config/robots/A.yaml");
  const Site site{"/knee_robot_that_nobody_started", [] { return true; }};
  control::HardwareFile file;
  for (const char* name : {"simulated", "pci"}) {
    file.backend = name;
    EXPECT_THROW(openBus(file, robot, site), InputError) << name;
    EXPECT_THROW(openOutputs(file, site), InputError) << name;
  }
  file.backend = "none such";
  EXPECT_THROW(openBus(file, robot, site), InputError);
}

TEST(Backends, GiveAMachineOneNameHoweverItIsSpelled) {
  const Site site{"/shm"};
  control::HardwareFile file = control::loadHardwareFile(KNEE_SOURCE_DIR "/config/hardware/can_simulated.yaml");
  file.can->interface = "/tmp/there/../bus";
  const std::string name = machineName(file, site);
  file.can->interface = "/tmp/./bus";
  EXPECT_EQ(name, machineName(file, site));
  file.can->interface = "/tmp/other_bus";
  EXPECT_NE(name, machineName(file, site));
  control::HardwareFile simulated = control::loadHardwareFile(KNEE_SOURCE_DIR "/config/hardware/simulated.yaml");
  EXPECT_NE(machineName(simulated, site), machineName(simulated, {"/other"}));
}

TEST(Backends, AreDrivenByNobodyWithoutAGuardianWhereOneWaitsOrTheCardsKeepWhatTheyHave) {
  const control::HardwareFile simulated = control::loadHardwareFile(KNEE_SOURCE_DIR "/config/hardware/simulated.yaml");
  EXPECT_EQ(whyNotUnguarded(simulated, false), "");
  EXPECT_NE(whyNotUnguarded(simulated, true).find("was not told of it"), std::string::npos);
  control::HardwareFile cards = control::loadHardwareFile(KNEE_SOURCE_DIR "/config/hardware/cards.yaml");
  EXPECT_NE(whyNotUnguarded(cards, false).find("no guardian"), std::string::npos);
  cards.bench_without_patient = true;
  EXPECT_EQ(whyNotUnguarded(cards, false), "");
  EXPECT_NE(whyNotUnguarded(cards, true), "");
}

}  // namespace
}  // namespace knee_robot::nodes
