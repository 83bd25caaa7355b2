// docs/safety.md holds a copy of the code's tables; this keeps it true.
#include "knee_robot/control/safety_tables.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "knee_robot/base/files.h"
#include "knee_robot/control/component_types.h"
#include "knee_robot/control/faults.h"
#include "knee_robot/rt/component_page.h"
#include "knee_robot/simulation/simulated_cards.h"

namespace knee_robot::control {
namespace {

TEST(SafetyTables, AreCopiedFaithfullyIntoTheDocumentation) {
  const std::string page = readFile(std::string(KNEE_SOURCE_DIR) + "/docs/safety.md");
  EXPECT_NE(page.find(faultsTable()), std::string::npos)
      << "replace the table by the output of: safety_tables --faults";
  EXPECT_NE(page.find(requestsTable()), std::string::npos)
      << "replace the table by the output of: safety_tables --requests";
}

TEST(ComponentPage, IsCopiedFaithfullyIntoTheDocumentation) {
  const std::string source = KNEE_SOURCE_DIR;
  const auto image = std::make_unique<simulation::RobotImage>();
  const auto bus = simulation::openImageCards(*image);
  const HardwareFile hardware = loadHardwareFile(source + "/config/hardware/simulated.yaml");
  const rt::TypeFactory types =
      componentTypes(mechanism::loadRobot(source + "/config/robots/A.yaml"), hardware, *bus, {});
  EXPECT_NE(readFile(source + "/docs/components.md").find(rt::componentPage(types)), std::string::npos)
      << "replace the tables by the output of: components --robot config/robots/A.yaml --hardware "
         "config/hardware/simulated.yaml";
}

TEST(Faults, EachHaveOneNameACauseAndARemedyAtTheirOwnPlace) {
  std::set<std::string> names;
  for (int i = 0; i < kFaults; ++i) {
    const auto fault = static_cast<Fault>(i);
    const FaultDescription& description = describe(fault);
    EXPECT_EQ(description.fault, fault) << description.name << " stands at the wrong place of the table";
    EXPECT_TRUE(names.insert(description.name).second) << description.name;
    EXPECT_FALSE(std::string(description.sentence).empty());
    if (fault != Fault::None) {
      EXPECT_FALSE(std::string(description.remedy).empty()) << description.name;
    }
    for (const char c : std::string(description.name))
      EXPECT_TRUE((c >= 'a' && c <= 'z') || c == '_') << description.name;
  }
}

}  // namespace
}  // namespace knee_robot::control
