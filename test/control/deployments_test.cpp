// Every deployment and hardware file of the configuration makes a controller.
#include <gtest/gtest.h>

#include <filesystem>

#include "fake_machine.h"
#include "knee_robot/control/control_system.h"

namespace knee_robot::control {
namespace {

std::vector<std::string> filesIn(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(KNEE_SOURCE_DIR) + folder))
    files.push_back(entry.path().string());
  return files;
}

TEST(Deployments, MakeAControllerThatStartsEach) {
  int made = 0;
  for (const std::string& path : filesIn("/config/deployment")) {
    fake::Machine machine(fake::robot());
    ControlSystem::Options options;
    options.empty = true;
    options.execution = rt::Execution::Stepped;
    ControlSystem system(fake::robot(), fake::hardware(), path, machine, options);
    const Answer started = system.start();
    EXPECT_TRUE(started.ok) << path << ": " << started.sentence;
    EXPECT_TRUE(system.enable().ok) << path;
    ++made;
  }
  EXPECT_GE(made, 3);
}

TEST(HardwareFiles, OfRealMachinesStartFaultedAndNotHomed) {
  const HardwareFile cards = loadHardwareFile(std::string(KNEE_SOURCE_DIR) + "/config/hardware/cards.yaml");
  EXPECT_EQ(cards.backend, "pci");
  EXPECT_TRUE(cards.starts_faulted);
  EXPECT_EQ(cards.homing.method, HomingMethod::HandPlaced);
  EXPECT_TRUE(cards.emergency_stop_clear_bit && cards.hand_switch_clear_bit);
}

}  // namespace
}  // namespace knee_robot::control
