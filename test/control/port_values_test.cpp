// What the ports carry, as numbers for plots: nothing is forgotten, and looking on costs the real-time path neither
// memory nor values.
#include "knee_robot/control/port_values.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "knee_robot/base/files.h"
#include "knee_robot/rt/port.h"
#include "system_rig.h"
#include "test/allocation_guard.h"

namespace knee_robot::control {
namespace {

std::vector<rt::PortBase*> allPorts(const rt::Deployment& deployment) {
  std::vector<rt::PortBase*> ports;
  for (const auto& component : deployment.components())
    ports.insert(ports.end(), component->ports().begin(), component->ports().end());
  return ports;
}

double valueNamed(const std::string& name, std::type_index type, const void* value) {
  std::vector<double> numbers;
  portValues(type, value, numbers);
  const std::vector<std::string> names = portValueNames(type);
  const auto found = std::find(names.begin(), names.end(), name);
  EXPECT_NE(found, names.end()) << name;
  return numbers.at(static_cast<std::size_t>(found - names.begin()));
}

TEST(PortValues, AreKnownForEveryPortOfEveryComponent) {
  fake::Rig rig;
  for (const rt::PortBase* port : allPorts(rig.system.deployment()))
    EXPECT_FALSE(portValueNames(port->type()).empty()) << port->fullName() << " carries " << port->typeName();
}

TEST(PortValues, DescribeEveryMemberOnceByANameOfItsOwn) {
  fake::Rig rig;
  std::set<std::type_index> types;
  for (const rt::PortBase* port : allPorts(rig.system.deployment()))
    types.insert(port->type());
  for (const std::type_index type : types) {
    const std::vector<std::string> names = portValueNames(type);
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
    PortTypeLayout layout = portTypeLayout(type);
    std::sort(layout.members.begin(), layout.members.end(),
              [](const auto& one, const auto& other) { return one.begin < other.begin; });
    layout.members.push_back({layout.size, layout.size, alignof(double)});
    std::size_t end = 0;
    for (const PortTypeLayout::Member& member : layout.members) {
      EXPECT_GE(member.begin, end) << layout.type << ": described twice before byte " << member.begin;
      EXPECT_LT(member.begin, end + member.alignment) << layout.type << ": missing before byte " << member.begin;
      end = member.end;
    }
    std::vector<double> numbers;
    const std::vector<char> zeros(layout.size, 0);
    portValues(type, zeros.data(), numbers);
    EXPECT_EQ(numbers.size(), names.size()) << layout.type;
  }
}

TEST(PortValues, AreCopiedFaithfullyIntoTheDocumentation) {
  const std::string page = readFile(std::string(KNEE_SOURCE_DIR) + "/docs/components.md");
  EXPECT_NE(page.find(portValuesTable()), std::string::npos) << "replace the table by the output of: components";
}

TEST(Tap, HandsOverEveryValueThatIsWrittenWhileItIsOpen) {
  fake::Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.play());
  rt::PortBase* const port = rig.system.deployment().component("Driver2")->port("command");
  rt::TapBase* const tap = port->tap();
  rig.system.run(0.1);
  rt::Nanoseconds at = 0;
  EXPECT_EQ(tap->next(at), nullptr) << "closed";
  tap->open();
  rig.system.run(0.3);
  std::vector<double> sequence;
  while (const void* value = tap->next(at)) {
    EXPECT_EQ(valueNamed("axis", port->type(), value), 2.0);
    sequence.push_back(valueNamed("sequence", port->type(), value));
  }
  ASSERT_NEAR(static_cast<double>(sequence.size()), 300.0, 1.0);
  for (std::size_t i = 1; i < sequence.size(); ++i)
    EXPECT_EQ(sequence[i], sequence[i - 1] + 1.0);
  EXPECT_EQ(tap->lost(), 0u);
  tap->close();
  rig.system.run(0.1);
  EXPECT_EQ(tap->next(at), nullptr) << "closed again";
}

TEST(Tap, ThatNobodyEmptiesLosesItsOwnValuesAndNobodyElses) {
  fake::Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.play());
  rt::TapBase* const tap = rig.system.deployment().component("AxesInput")->port("measurement")->tap();
  tap->open();
  rig.system.run(0.8);
  EXPECT_NEAR(static_cast<double>(tap->lost()), 800.0 - rt::TapBase::kValues, 2.0);
  EXPECT_EQ(rig.system.state(), MachineState::Playing);
}

TEST(Tap, OfAnInputIsThatOfTheOutputBehindIt) {
  fake::Rig rig;
  const rt::Deployment& deployment = rig.system.deployment();
  rt::PortBase* const input = deployment.component("AxesOutput")->port("command_3");
  EXPECT_EQ(input->source(), deployment.component("Driver3")->port("command"));
  EXPECT_EQ(input->tap(), nullptr);
}

TEST(AllocationGuard, FindsNoneWhileEveryPortIsLookedAt) {
  fake::Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.play());
  for (rt::PortBase* port : allPorts(rig.system.deployment())) {
    if (port->isOutput()) port->tap()->open();
  }
  allocations = 0;
  std::size_t updates = 0;
  rig.injection.around = [&updates](const std::string&, bool begins) {
    armed = begins;
    updates += begins ? 1 : 0;
  };
  rig.system.run(1.0);
  armed = false;
  rig.injection.around = nullptr;
  EXPECT_GT(updates, 1000u);
  EXPECT_EQ(allocations, 0);
}

}  // namespace
}  // namespace knee_robot::control
