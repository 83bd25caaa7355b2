// The laboratory's own reference files: the verdict on every file, robot and space. The files are not part of this
// repository.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "knee_robot/base/errors.h"
#include "knee_robot/trajectory/reference_check.h"
#include "test/trajectory/robots.h"

namespace knee_robot::trajectory {
namespace {

std::string referenceFolder() {
  const char* shared = std::getenv("KNEE_SHARED_DIR");
  return (shared ? std::string(shared) : std::string(KNEE_SOURCE_DIR) + "/../shared") + "/data/references/";
}

#define SKIP_WITHOUT_LABORATORY_FILES() \
  if (!std::filesystem::is_directory(referenceFolder())) GTEST_SKIP() << "no laboratory files in " << referenceFolder()

/// "played", or the quantity that refuses it, or "mismatch" for a robot without the space.
std::string verdict(const std::string& file, const mechanism::Robot& robot, Space space) {
  try {
    const ReferenceCheck check = checkReference(readReference(referenceFolder() + file, space), robot);
    return check.ok() ? "played" : nameOf(check.violation->at.quantity);
  } catch (const InputError&) {
    return "mismatch";
  }
}

enum class Kind { Lengths, Poses, FromHome };
const std::map<std::string, Kind> kFiles = {
    {"refeprism_indep_TRR8.txt", Kind::Lengths},    {"ref_qinde_TRR0_CF1_IdV1.txt", Kind::Lengths},
    {"ref_qinde_TR15_CF1_V1.txt", Kind::Lengths},   {"ref_qinde_TRR17_CF1_5P_IdV1.txt", Kind::Lengths},
    {"refecart_TRR8_identificar.txt", Kind::Poses}, {"ref_cart_TRR0_CF1_IdV1.txt", Kind::Poses},
    {"refeprism_pata1234.txt", Kind::FromHome},     {"referencia_manual.txt", Kind::FromHome},
};

/// Lengths, limits and assembly admit each of them on either robot (their limits are the same and their margins wide
/// open):
/// which of the two a file was made for is not a matter of safety. A space that the file does not have is always
/// refused, because lengths are 0.6 to 1.0 m, poses have coordinates near 0, and what counts from home starts with 0.
TEST(LaboratoryReferences, PlayOnTheParallelRobotsInTheirOwnSpaceAndInNoOther) {
  SKIP_WITHOUT_LABORATORY_FILES();
  for (const char* robot_name : {"A", "B"}) {
    const mechanism::Robot robot = configuredRobot(robot_name);
    for (const auto& [file, kind] : kFiles) {
      SCOPED_TRACE(file + " on " + robot_name);
      const bool lengths = kind == Kind::Lengths;
      EXPECT_EQ(verdict(file, robot, Space::Actuator), lengths ? "played" : "shortest length");
      EXPECT_EQ(verdict(file, robot, Space::Platform), kind == Kind::Poses ? "played"
                                                       : lengths           ? "longest length"
                                                                           : "shortest length");
      const std::string relative = verdict(file, robot, Space::Relative);
      if (kind == Kind::FromHome) {
        EXPECT_EQ(relative, "played");
      } else {
        EXPECT_TRUE(relative == "longest length" || relative == "shortest length") << relative;
      }
    }
  }
}

/// refeprism_pata1234 sends all four actuators together from 0 to 0.24 m, which is what the bench's recording shows;
/// both files from home start with exactly 0, so on a bench, whose home is 0, they are positions as well.
TEST(LaboratoryReferences, OnlyTheOnesFromHomePlayOnTheBench) {
  SKIP_WITHOUT_LABORATORY_FILES();
  const mechanism::Robot bench = configuredRobot("bench");
  for (const auto& [file, kind] : kFiles) {
    SCOPED_TRACE(file);
    const std::string expected = kind == Kind::FromHome  ? "played"
                                 : kind == Kind::Lengths ? "longest length"
                                                         : "shortest length";
    EXPECT_EQ(verdict(file, bench, Space::Actuator), expected);
    EXPECT_EQ(verdict(file, bench, Space::Relative), expected);
    EXPECT_EQ(verdict(file, bench, Space::Platform), "mismatch");
  }
}

/// The pair of TRR8 files is the same motion in both spaces, written down with six decimals: that ties them to robot A.
TEST(LaboratoryReferences, TheCartesianTrr8IsTheActuatorTrr8OnRobotAAndNotOnB) {
  SKIP_WITHOUT_LABORATORY_FILES();
  const Reference poses = readReference(referenceFolder() + "refecart_TRR8_identificar.txt", Space::Platform);
  const Reference lengths = readReference(referenceFolder() + "refeprism_indep_TRR8.txt");
  const auto difference = [&](const char* robot_name) {
    const Points converted = checkReference(poses, configuredRobot(robot_name)).lengths;
    return (converted.topRows(8000) - lengths.points.topRows(8000)).cwiseAbs().maxCoeff();
  };
  EXPECT_LE(difference("A"), 2.5e-6);
  EXPECT_GE(difference("B"), 1e-2);
}

/// The final geometry as the paper built it has shorter legs and tighter joints than the laboratory's robot A.
TEST(LaboratoryReferences, MeetTheTighterLimitsOfTheFinalRobot) {
  SKIP_WITHOUT_LABORATORY_FILES();
  const mechanism::Robot robot = configuredRobot("final");
  EXPECT_EQ(verdict("ref_qinde_TRR0_CF1_IdV1.txt", robot, Space::Actuator), "played");
  EXPECT_EQ(verdict("refeprism_indep_TRR8.txt", robot, Space::Actuator), "platform joint angle");
  EXPECT_EQ(verdict("ref_qinde_TRR17_CF1_5P_IdV1.txt", robot, Space::Actuator), "longest length");
}

TEST(LaboratoryReferences, HaveTheAccelerationsThatTheirRecordsMention) {
  SKIP_WITHOUT_LABORATORY_FILES();
  const auto acceleration = [&](const char* file, const char* robot) {
    const ReferenceCheck check = checkReference(readReference(referenceFolder() + file), configuredRobot(robot));
    for (const Margin& margin : check.margins) {
      if (margin.quantity == Quantity::Acceleration) return margin.value;
    }
    return 0.0;
  };
  EXPECT_NEAR(acceleration("refeprism_indep_TRR8.txt", "A"), 2.6, 0.05);
  EXPECT_NEAR(acceleration("ref_qinde_TRR17_CF1_5P_IdV1.txt", "B"), 3.7, 0.06);
}

}  // namespace
}  // namespace knee_robot::trajectory
