// Every deployment and hardware file of the configuration makes a controller.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "fake_machine.h"
#include "knee_robot/base/files.h"
#include "knee_robot/control/component_types.h"
#include "knee_robot/control/control_system.h"
#include "src/control/wide_limits.h"

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

double numberOf(const rt::PropertyBase* property) {
  if (const auto* real = dynamic_cast<const rt::Property<double>*>(property)) return real->value();
  if (const auto* whole = dynamic_cast<const rt::Property<int>*>(property)) return whole->value();
  return std::nan("");
}

/// The table repeats what components say of themselves; a default that changes, or a property that gets another name, has
/// to change it, too.
TEST(WideLimits, AreAboutThreeTimesWhatTheComponentsThemselvesHaveAsDefaults) {
  fake::Machine machine(fake::robot());
  const rt::TypeFactory types = componentTypes(fake::robot(), fake::hardware(), machine, {});
  const std::vector<WideLimit> all = wideLimits();
  EXPECT_GT(all.size(), 50u);
  for (const WideLimit& limit : all) {
    const auto component = types.at(limit.type)("it");
    const double usual = numberOf(component->property(limit.property));
    const std::string what = limit.type + "." + limit.property + ": " + std::to_string(usual);
    EXPECT_TRUE(usual >= limit.least && usual <= limit.most) << what;
    if (std::isfinite(limit.most) && usual > 0.0) {
      EXPECT_LE(limit.most, 4.01 * usual) << what;
    }
    if (!std::isfinite(limit.most)) {
      EXPECT_GE(limit.least, 0.29 * usual) << what;
    }
  }
}

struct NotInTheTable {
  std::string property, why;
};
const NotInTheTable kNotInTheTable[] = {
    {"Monitors.acceleration_factor", "PatientChecklist has a limit of its own for it"},
    {"Monitors.thermal_start", "its default is the widest"},
    {"Driver.axis", "it names the axis"},
    {"Driver.proportional_N_per_m", "a gain: what it lets happen, following error and monitors find"},
    {"Driver.integral_N_per_m_s", "a gain"},
    {"Driver.derivative_N_s_per_m", "a gain"},
    {"Driver.derivative_cutoff_hz", "a gain's filter"},
    {"Driver.probe_s", "PatientChecklist asks whether encoders are tested"},
    {"Supervisor.settle_s", "the brakes hold meanwhile"},
    {"Supervisor.enable_limit_s", "the brakes hold meanwhile"},
    {"AxesOutput.settle_s", "the loops hold meanwhile, and monitors watch"},
    {"HandGuide.damping_N_s_per_m", "how it feels: its speed limits hold with any"},
    {"HandGuide.linear_m_per_s", "the patient's own limit holds where it is lower"},
    {"HandGuide.angular_rad_per_s", "the patient's own limit holds where it is lower"},
};

/// A limit that nobody put into the table could be opened wide beside a patient.
TEST(WideLimits, HaveEveryNumberOfTheirComponentsOrAReasonWhyNot) {
  fake::Machine machine(fake::robot());
  const rt::TypeFactory types = componentTypes(fake::robot(), fake::hardware(), machine, {});
  std::set<std::string> judged, judged_types, excused;
  for (const WideLimit& limit : wideLimits()) {
    judged.insert(limit.type + "." + limit.property);
    judged_types.insert(limit.type);
  }
  for (const NotInTheTable& one : kNotInTheTable)
    excused.insert(one.property);
  EXPECT_GE(judged_types.size(), 7u);
  for (const std::string& type : judged_types) {
    const auto component = types.at(type)("it");
    for (const rt::PropertyBase* property : component->properties()) {
      if (std::isnan(numberOf(property))) continue;
      const std::string name = type + "." + property->name();
      EXPECT_EQ(judged.count(name) + excused.erase(name), 1u)
          << name << ": give it a row in src/control/wide_limits.cpp, or a reason here";
    }
  }
  EXPECT_TRUE(excused.empty()) << *excused.begin() << " is no number of a component in the table";
}

std::string opened(const std::string& path) {
  fake::Machine machine(fake::robot());
  ControlSystem::Options options;
  options.execution = rt::Execution::Stepped;
  const ControlSystem system(fake::robot(), fake::hardware(), path, machine, options);
  std::string all;
  for (const std::string& one : limitsOpenedWide(MachineComponents(system.deployment())))
    all += one + "; ";
  return all;
}

TEST(WideLimits, AreExceededByTheDeploymentsOfTheSimulatedRobotOnly) {
  for (const std::string& path : filesIn("/config/deployment")) {
    const std::string name = std::filesystem::path(path).filename();
    const bool simulated = name == "simulation.yaml" || name == "can.yaml";
    // It is a process of its own that nobody schedules in real time, and its motors cannot get hot.
    EXPECT_EQ(opened(path), simulated ? "Monitors.velocity_s 0.05 (at most 0.02); "
                                        "Monitors.jump_acceleration_m_per_s2 1e+06 (at most 600); "
                                        "Monitors.thermal_time_constant_s 1000 (at most 120); "
                                      : "")
        << name;
  }
}

TEST(WideLimits, AreKeptByWhatTheLaunchFilesOfRealMachinesStart) {
  int started = 0;
  for (const std::string& path : filesIn("/launch")) {
    const std::string name = std::filesystem::path(path).filename();
    if (name.find("industrial_pc") == std::string::npos) continue;
    const std::string text = readFile(path);
    const std::string before = "name=\"deployment\" default=\"$(find knee_robot)";
    const std::size_t from = text.find(before);
    ASSERT_NE(from, std::string::npos) << name;
    const std::size_t begin = from + before.size();
    EXPECT_EQ(opened(KNEE_SOURCE_DIR + text.substr(begin, text.find('"', begin) - begin)), "") << name;
    ++started;
  }
  EXPECT_EQ(started, 2);
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
