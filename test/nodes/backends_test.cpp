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

}  // namespace
}  // namespace knee_robot::nodes
