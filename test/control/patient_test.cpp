// Patient files: read strictly, never above the robot's limits, checked on loading and watched in motion.
#include <gtest/gtest.h>

#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/control/patient_limits.h"
#include "src/control/monitor_patient.h"
#include "system_rig.h"
#include "test/mechanism/configured_robot.h"
#include "test/refusal.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

const char* const kGood = R"(patient: "17"
pose: {X_m: [-0.05, 0.05], Z_m: [0.60, 0.70], theta_deg: [-5, 20], psi_deg: [-10, 10]}
speed: {linear_mm_per_s: 15}
)";

mechanism::Robot finalRobot() {
  return mechanism::configuredRobot("final");
}

class PatientFile : public ::testing::Test {
 protected:
  std::string file(const std::string& text) const {
    writeFileAtomically(folder + "/p.yaml", text);
    return folder + "/p.yaml";
  }
  std::string refusalOf(const std::string& from, const std::string& to) const {
    std::string text = kGood;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    const std::string path = file(text);
    try {
      loadPatientLimits(path, finalRobot());
    } catch (const InputError& error) {
      return std::string(error.what()).substr(path.size());
    }
    return "";
  }
  const TemporaryFolder folder;
};

TEST_F(PatientFile, IsReadWithThePapersSpeedsWhereItSaysNothing) {
  const PatientLimits patient = loadPatientLimits(file(kGood), finalRobot());
  EXPECT_EQ(patient.name, "17");
  EXPECT_TRUE(patient.range.given);
  EXPECT_DOUBLE_EQ(patient.range.linear_m_per_s, 0.015);
  EXPECT_NEAR(patient.range.angular_rad_per_s, 2.0 * kDegree, 1e-9);
  EXPECT_NEAR(patient.range.maximum[2], 20.0 * kDegree, 1e-12);
  std::string text = kGood;
  const PatientLimits plain = loadPatientLimits(file(text.substr(0, text.find("speed"))), finalRobot());
  EXPECT_DOUBLE_EQ(plain.range.linear_m_per_s, 0.020);
}

TEST_F(PatientFile, MayLimitForceAndMomentAtThePlatform) {
  const PatientLimits none = loadPatientLimits(file(kGood), finalRobot());
  EXPECT_FALSE(none.range.limitsForce());
  EXPECT_TRUE(none.range.allowsForce({1e6, 0.0, 1e6, 0.0}));
  const PatientLimits some = loadPatientLimits(file(std::string(kGood) + "force: {force_N: 60}\n"), finalRobot());
  EXPECT_TRUE(some.range.limitsForce());
  EXPECT_TRUE(some.range.allowsForce({40.0, -40.0, 500.0, 0.0}));
  EXPECT_FALSE(some.range.allowsForce({50.0, -40.0, 0.0, 0.0}));
  const PatientLimits moment = loadPatientLimits(file(std::string(kGood) + "force: {moment_Nm: 15}\n"), finalRobot());
  EXPECT_FALSE(moment.range.allowsForce({0.0, 0.0, 0.0, -16.0}));
}

TEST_F(PatientFile, IsRefusedByLineWhenSenselessOrAboveTheRobot) {
  EXPECT_EQ(refusalOf("linear_mm_per_s: 15", "linear_mm_per_s: 250")
                .rfind(":3: linear_mm_per_s: 250 is outside 0.1 .. 200", 0),
            0u)
      << "the robot's own 0.2 m/s";
  EXPECT_EQ(refusalOf("Z_m: [0.60, 0.70]", "Z_m: [0.70, 0.60]").rfind(":2: Z_m: expected [smallest, largest]", 0), 0u);
  EXPECT_NE(refusalOf("psi_deg: [-10, 10]", "psi_deg: [-10, nan]"), "");
  EXPECT_NE(refusalOf("psi_deg: [-10, 10]", "psi_deg: [-10, 100]"), "");
  EXPECT_NE(refusalOf("psi_deg", "psi"), "");
  EXPECT_NE(refusalOf("patient: \"17\"", "patient: \"\""), "");
  EXPECT_NE(refusalOf("speed:", "speeds:"), "");
  EXPECT_THROW(loadPatientLimits(file(kGood), fake::robot()), InputError) << "a bench has no platform";
}

trajectory::Reference platformReference(double from_z, double to_z, double turn_deg, double seconds) {
  trajectory::Reference reference;
  reference.name = "exercise.txt";
  reference.space = trajectory::Space::Platform;
  const auto intervals = static_cast<Eigen::Index>(std::lround(seconds / trajectory::kStreamPeriod));
  reference.points.resize(intervals + 1, 4);
  for (Eigen::Index k = 0; k <= intervals; ++k) {
    const double x = static_cast<double>(k) / static_cast<double>(intervals);
    const double share = x * x * x * (10.0 + x * (6.0 * x - 15.0));
    reference.points.row(k) << 0.0, from_z + share * (to_z - from_z), share * turn_deg * kDegree, 0.0;
  }
  return reference;
}

std::string verdict(const trajectory::Reference& reference, const PatientLimits& patient) {
  return refusalOf(
      [&] { requireWithinPatient(trajectory::requirePlayable(reference, finalRobot()), reference, patient); });
}

TEST_F(PatientFile, HoldsReferencesToItsRangeAndSpeeds) {
  const PatientLimits patient = loadPatientLimits(file(kGood), finalRobot());
  EXPECT_EQ(verdict(platformReference(0.61, 0.66, 0.0, 8.0), patient), "");
  EXPECT_NE(verdict(platformReference(0.61, 0.72, 0.0, 20.0), patient).find("Zm is 0.7"), std::string::npos);
  const std::string fast = verdict(platformReference(0.61, 0.66, 0.0, 4.0), patient);
  EXPECT_EQ(fast.rfind("exercise.txt:", 0), 0u) << fast;
  EXPECT_NE(fast.find("mm/s, faster than the patient's 15"), std::string::npos) << fast;
  EXPECT_NE(verdict(platformReference(0.65, 0.65, 5.0, 2.0), patient).find("deg/s"), std::string::npos);
}

TEST_F(PatientFile, IsWatchedInMotionByPoseAndSpeed) {
  const mechanism::Robot robot = finalRobot();
  const PatientLimits patient = loadPatientLimits(file(kGood), robot);
  using Verdict = PatientMonitor::Verdict;
  /// Moves upwards from 0.61 m by `way(time)` and answers what the monitor says first, and when.
  const auto watch = [&](auto way, double seconds) {
    knee_robot::control::PatientMonitor monitor(robot);
    for (int k = 0; k < static_cast<int>(seconds * 1000); ++k) {
      const mechanism::Lengths lengths =
          mechanism::legLengths(*robot.mechanism, mechanism::Pose(0.0, 0.61 + way(1e-3 * k), 0.0, 0.0));
      const Verdict verdict =
          monitor.step(patient.range, {lengths[0], lengths[1], lengths[2], lengths[3]}, 1e-3, 0.002, 0.01, 1.3);
      if (verdict != Verdict::Fine) return std::pair(verdict, 1e-3 * k);
    }
    return std::pair(Verdict::Fine, seconds);
  };
  const auto steady = [](double speed) { return [speed](double t) { return speed * t; }; };
  EXPECT_EQ(watch(steady(0.015), 5.0).first, Verdict::Fine);
  EXPECT_EQ(watch(steady(0.015), 7.0).first, Verdict::Pose);
  EXPECT_EQ(watch(steady(0.025), 1.0).first, Verdict::Speed);
  const auto [fast, after] = watch([](double t) { return 0.01 * t + std::max(0.0, t - 2.0) * 0.06; }, 3.0);
  EXPECT_EQ(fast, Verdict::Speed);
  EXPECT_LT(after, 2.0 + PatientMonitor::kWindow_s);
  const auto slips = [](double t) {  // a dry screw: stands for 0.08 s, makes up for it in 0.02 s
    const double step = std::floor(t / 0.1);
    return 0.01 * 0.1 * (step + std::max(0.0, (t / 0.1 - step - 0.8) / 0.2));
  };
  EXPECT_EQ(watch(slips, 3.0).first, Verdict::Fine) << "five times as fast for moments, but no way";
  const auto shakes = [](double amplitude) {
    return [amplitude](double t) { return amplitude * std::sin(12.0 * M_PI * t); };
  };
  EXPECT_EQ(watch(shakes(0.001), 5.0).first, Verdict::Fine) << "24 mm/s in the mean, to and fro";
  EXPECT_EQ(watch(shakes(0.0015), 5.0).first, Verdict::Speed) << "36 mm/s";
  PatientMonitor monitor(robot);
  EXPECT_EQ(monitor.step(patient.range, {0.6, 0.6, std::nan(""), 0.6}, 1e-3, 0.002, 0.01, 1.3), Verdict::Pose);
  EXPECT_EQ(monitor.step(PatientRange{}, {0.1, 0.1, 0.1, 0.1}, 1e-3, 0.002, 0.01, 1.3), Verdict::Fine)
      << "nobody there";
}

TEST(Patient, MayNotBeOnABenchThatSaysSo) {
  HardwareFile hardware = fake::hardware();
  hardware.bench_without_patient = true;
  fake::Rig rig(hardware);
  const Answer answer = rig.system.loadPatient("anything.yaml");
  EXPECT_FALSE(answer.ok);
  EXPECT_NE(answer.sentence.find("bench_without_patient"), std::string::npos);
}

}  // namespace
}  // namespace knee_robot::control
