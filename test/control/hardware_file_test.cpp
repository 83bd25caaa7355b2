#include "knee_robot/control/hardware_file.h"

#include <gtest/gtest.h>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

const char* const kGood = R"(backend: simulated
digital_outputs: {drive_enable: 0, hold_release: 1, heartbeat: 2}
axes:
  - {hold_device: brake, hold_delay_s: 0.03}
  - {hold_device: shorted_windings, hold_delay_s: 0.01}
  - {hold_device: brake, hold_delay_s: 0.05}
  - {hold_device: brake, hold_delay_s: 0.03}
)";

HardwareFile parsed(const std::string& text, std::string* refusal = nullptr) {
  const TemporaryFolder folder;
  const std::string path = folder + "/h.yaml";
  writeFileAtomically(path, text);
  HardwareFile file;
  try {
    file = loadHardwareFile(path);
  } catch (const InputError& error) {
    if (refusal != nullptr) *refusal = std::string(error.what()).substr(path.size());
  }
  return file;
}

std::string refusalOfHardware(const std::string& from, const std::string& to) {
  std::string text = kGood;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  std::string refusal;
  parsed(text.replace(at, from.size(), to), &refusal);
  return refusal;
}

TEST(HardwareFile, ReadsWhatHoldsEachAxis) {
  const HardwareFile file = parsed(kGood);
  EXPECT_EQ(file.axes[1].hold_device, HoldDevice::ShortedWindings);
  EXPECT_EQ(file.axes[3].hold_device, HoldDevice::Brake);
  EXPECT_DOUBLE_EQ(file.holdDelay(), 0.05);
  EXPECT_FALSE(file.emergency_stop_clear_bit);
}

TEST(HardwareFile, RefusesAnAxisThatNothingHoldsExceptOnABenchWithoutPatient) {
  const std::string refusal = refusalOfHardware("shorted_windings", "none");
  EXPECT_EQ(refusal.rfind(":5: hold_device: none lets the platform fall", 0), 0u) << refusal;
  std::string text = std::string("bench_without_patient: true\n") + kGood;
  text.replace(text.find("shorted_windings"), 16, "none");
  EXPECT_EQ(parsed(text).axes[1].hold_device, HoldDevice::None);
}

TEST(HardwareFile, RefusesWhatIsSenselessByLine) {
  EXPECT_EQ(refusalOfHardware("heartbeat: 2", "heartbeat: 1").rfind(":2: heartbeat: ", 0), 0u);
  EXPECT_EQ(refusalOfHardware("heartbeat: 2", "heartbeat: 4").rfind(":2: heartbeat: 4 is outside 0 .. 3", 0), 0u);
  EXPECT_EQ(refusalOfHardware("backend: simulated", "backend: relays").rfind(":1: backend: ", 0), 0u);
  EXPECT_EQ(refusalOfHardware("  - {hold_device: shorted_windings, hold_delay_s: 0.01}\n", "")
                .rfind(":4: axes: expected four", 0),
            0u);
  EXPECT_NE(refusalOfHardware("hold_delay_s: 0.05", "hold_delay: 0.05"), "");
}

TEST(HardwareFile, StartsFaultedAndHomedByHandUnlessItSaysOtherwise) {
  const HardwareFile plain = parsed(kGood);
  EXPECT_TRUE(plain.starts_faulted);
  EXPECT_EQ(plain.homing.method, HomingMethod::HandPlaced);
  const HardwareFile file = parsed(std::string(kGood) + R"(starts_faulted: false
digital_inputs: {emergency_stop_clear: 3, hand_switch_clear: 1, home_switch: 2}
homing: {method: switch, order: [4, 1, 2, 3], axes: [{length_m: 0.61, direction: lengthen, force_N: 40}]}
)");
  EXPECT_FALSE(file.starts_faulted);
  EXPECT_EQ(file.hand_switch_clear_bit, 1);
  EXPECT_EQ(file.homing.method, HomingMethod::Switch);
  EXPECT_EQ(file.homing.order[0], 4);
  EXPECT_EQ(file.homing.axes[2].direction, 1);
  EXPECT_DOUBLE_EQ(file.homing.axes[3].force_N, 40.0);
}

TEST(HardwareFile, RefusesHomingAndInputsThatCannotBe) {
  const auto refusal = [](const std::string& more) {
    std::string text;
    parsed(std::string(kGood) + more, &text);
    return text;
  };
  const std::string axes = "axes: [{length_m: 0.61, direction: shorten}]";
  EXPECT_NE(
      refusal("digital_inputs: {emergency_stop_clear: 1, hand_switch_clear: 1}\n").find("every input needs its own"),
      std::string::npos);
  EXPECT_NE(refusal("homing: {method: switch, " + axes + "}\n").find("home_switch"), std::string::npos);
  EXPECT_NE(refusal("homing: {method: hard_stop}\n").find("axes"), std::string::npos);
  const std::string no_way_back = "axes: [{length_m: 0.5, direction: shorten, back_off_m: 0.0}]}\n";
  EXPECT_NE(refusal("homing: {method: hard_stop, " + no_way_back).find("back_off_m"), std::string::npos);
  const std::string switches = "digital_inputs: {emergency_stop_clear: 1, hand_switch_clear: 2, home_switch: 3}\n";
  EXPECT_NE(refusal(switches + "homing: {method: switch, " + no_way_back).find("back_off_m"), std::string::npos);
  EXPECT_NE(refusal("homing: {method: hard_stop, order: [1, 1, 2, 3], " + axes + "}\n").find("each of the axes"),
            std::string::npos);
  EXPECT_NE(refusal("homing: {method: hand_placed, " + axes + "}\n"), "") << "axes that nothing moves";
  EXPECT_NE(refusal("homing: {method: guessed}\n"), "");
  EXPECT_EQ(refusal("homing: {method: assumed}\n"), "") << "fine on the simulated backend";
  std::string text;
  std::string real = std::string(kGood) + "homing: {method: assumed}\n";
  parsed(real.replace(real.find("simulated"), 9, "pci"), &text);
  EXPECT_NE(text.find("takes for granted"), std::string::npos) << text;
}

TEST(HardwareFile, IsReadFromTheConfiguration) {
  const HardwareFile file = loadHardwareFile(std::string(KNEE_SOURCE_DIR) + "/config/hardware/simulated.yaml");
  EXPECT_EQ(file.backend, "simulated");
  EXPECT_FALSE(file.bench_without_patient);
}

}  // namespace
}  // namespace knee_robot::control
