// What must be so before a patient may lie in a machine, sentence by sentence.
#include "src/control/patient_checklist.h"

#include <gtest/gtest.h>

#include <functional>

#include "fake_machine.h"

namespace knee_robot::control {
namespace {

/// A real machine on which a patient may lie.
PatientChecklist fit() {
  mechanism::Robot robot = fake::robot();
  for (mechanism::Actuator& actuator : robot.actuators)
    actuator.force_max_N = 1000.0;
  robot.singularity_condition_max = 100.0;
  HardwareFile hardware = fake::hardware();
  hardware.backend = "pci";
  hardware.emergency_stop_clear_bit = 0;
  hardware.hand_switch_clear_bit = 1;
  PatientChecklist list(robot, hardware);
  list.guarded = true;
  list.allowed_silence_s = 0.1;
  list.acceleration_factor = 3.0;
  list.asks_encoders = true;
  return list;
}

PatientLimits patient() {
  PatientLimits limits;
  limits.path = "p17.yaml";
  return limits;
}

TEST(PatientChecklists, AdmitAPatientToAMachineThatLacksNothing) {
  EXPECT_EQ(fit().obstacles(), "");
  const Answer answer = fit().admit(patient());
  EXPECT_TRUE(answer.ok);
  EXPECT_EQ(answer.sentence, "");
}

TEST(PatientChecklists, NameEachThingThatIsMissingAndRefuseForItAlone) {
  struct Case {
    const char* word;
    std::function<void(PatientChecklist&)> lacks;
  };
  const Case cases[] = {
      {"no guardian watches", [](PatientChecklist& list) { list.guarded = false; }},
      {"a silence of 101 ms, at most 100", [](PatientChecklist& list) { list.allowed_silence_s = 0.101; }},
      {"no real-time scheduling (SCHED_FIFO is refused)",
       [](PatientChecklist& list) { list.lacking_privileges = {"SCHED_FIFO is refused"}; }},
      {"no emergency stop", [](PatientChecklist& list) { list.has_emergency_stop = false; }},
      {"no hand switch", [](PatientChecklist& list) { list.has_hand_switch = false; }},
      {"no force limits", [](PatientChecklist& list) { list.has_force_limits = false; }},
      {"singularity margin is wide open", [](PatientChecklist& list) { list.singularity_condition_max = 1001.0; }},
      {"acceleration_factor 11", [](PatientChecklist& list) { list.acceleration_factor = 11.0; }},
      {"no serial number", [](PatientChecklist& list) { list.knows_its_drives = false; }},
      {"never tests whether its encoder counts", [](PatientChecklist& list) { list.asks_encoders = false; }},
      {"opens limits wide: Supervisor.brake_test_N 0 (at least 60)",
       [](PatientChecklist& list) { list.opened_wide = {"Supervisor.brake_test_N 0 (at least 60)"}; }},
      {"the platform would jump", [](PatientChecklist& list) { list.strange_weights = "the platform would jump"; }},
  };
  for (const Case& one : cases) {
    PatientChecklist list = fit();
    one.lacks(list);
    const Answer answer = list.admit(patient());
    EXPECT_FALSE(answer.ok) << one.word;
    EXPECT_NE(answer.sentence.find(one.word), std::string::npos) << answer.sentence;
    EXPECT_EQ(answer.sentence.find("; no"), std::string::npos) << "nothing else: " << answer.sentence;
  }
}

TEST(PatientChecklists, NameAllThatIsMissingAtOnce) {
  PatientChecklist list = fit();
  list.guarded = list.has_hand_switch = false;
  const std::string all = list.obstacles();
  EXPECT_NE(all.find("guardian"), std::string::npos);
  EXPECT_NE(all.find("hand switch"), std::string::npos);
}

TEST(PatientChecklists, OnlyTellWhatIsMissingWhereTheRobotIsSimulated) {
  PatientChecklist list = fit();
  list.simulated = true;
  list.guarded = false;
  const Answer answer = list.admit(patient());
  EXPECT_TRUE(answer.ok);
  EXPECT_NE(answer.sentence.find("on a real robot this would be refused: no guardian"), std::string::npos);
}

TEST(PatientChecklists, RefuseABenchWhateverElseIsThere) {
  PatientChecklist list = fit();
  list.bench_without_patient = list.simulated = true;
  EXPECT_FALSE(list.admit(patient()).ok);
}

TEST(PatientChecklists, RefuseForceLimitsThatNothingWouldJudge) {
  PatientLimits limited = patient();
  limited.range.force_N = 60.0;
  PatientChecklist list = fit();
  const Answer answer = list.admit(limited);
  EXPECT_FALSE(answer.ok);
  EXPECT_NE(answer.sentence.find("identified model"), std::string::npos) << answer.sentence;
  list.monitors_forces = true;
  EXPECT_TRUE(list.admit(limited).ok);
}

TEST(PatientChecklists, TakeALimitThatIsNoNumberForMissing) {
  PatientChecklist list = fit();
  list.singularity_condition_max = std::nan("");
  EXPECT_FALSE(list.admit(patient()).ok);
}

TEST(PatientChecklists, ReadTheRobotsAndTheHardwaresFacts) {
  const PatientChecklist list(fake::robot(), fake::hardware());
  EXPECT_FALSE(list.has_force_limits) << "three actuators have no largest force";
  EXPECT_FALSE(list.has_emergency_stop);
  EXPECT_TRUE(list.simulated);
  EXPECT_FALSE(list.guarded);
}

}  // namespace
}  // namespace knee_robot::control
