// Who is on the robot, without a controller.
#include "src/control/occupancy_record.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "test/mechanism/configured_robot.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

class OccupancyRecords : public ::testing::Test {
 protected:
  void SetUp() override {
    patient.path = folder + "/p17.yaml";
    patient.name = "17";
    patient.range.given = true;
    writeFileAtomically(patient.path, "patient: \"17\"\n");
  }

  const TemporaryFolder folder;
  std::string busy;
  PatientLimits patient;
  std::vector<Occupancy> told;
  std::function<void()> asked = [] {};
  OccupancyRecord record{PatientMemory(""),
                         [this] {
                           asked();
                           return busy;
                         },
                         [this](Occupancy now, const PatientRange&) { told.push_back(now); }};
};

TEST_F(OccupancyRecords, BeginUnknownAndMoveNothing) {
  EXPECT_EQ(record.occupancy(), Occupancy::Unknown);
  EXPECT_NE(record.whyNobodyMoves().find("nobody has said who is on the robot"), std::string::npos);
}

TEST_F(OccupancyRecords, TellEveryChangeOnce) {
  ASSERT_TRUE(record.change(Occupancy::Empty, std::nullopt).ok);
  EXPECT_EQ(record.whyNobodyMoves(), "");
  ASSERT_TRUE(record.change(Occupancy::Patient, patient).ok);
  EXPECT_EQ(record.patient()->name, "17");
  EXPECT_EQ(told, (std::vector<Occupancy>{Occupancy::Empty, Occupancy::Patient}));
}

TEST_F(OccupancyRecords, AreWrittenDownAnewWhereSomebodyHasRemovedTheirFile) {
  const PatientMemory memory(folder + "/state/patient.txt");
  OccupancyRecord kept{memory, [] { return std::string(); }, [](Occupancy, const PatientRange&) {}};
  kept.keep();
  EXPECT_FALSE(memory.isThere()) << "nobody is on it";
  ASSERT_TRUE(kept.change(Occupancy::Patient, patient).ok);
  std::filesystem::remove_all(folder + "/state");
  kept.keep();
  EXPECT_EQ(memory.remembered().path, patient.path) << "once forgotten by the next start";
  ASSERT_TRUE(kept.change(Occupancy::Empty, std::nullopt).ok);
  kept.keep();
  EXPECT_FALSE(memory.isThere()) << "the patient has left";
}

TEST_F(OccupancyRecords, BehindALinkThatLeadsNowhereAreNotForgotten) {
  std::filesystem::create_directory_symlink(folder + "/disk", folder + "/state");
  std::filesystem::create_symlink(folder + "/nowhere", folder + "/link");
  for (const std::string& path : {folder + "/state/left/patient.txt", folder + "/state/patient.txt", folder + "/link"})
    EXPECT_THROW(PatientMemory(path).remembered(), InputError) << path;
  std::filesystem::create_directory(folder + "/disk");
  EXPECT_EQ(PatientMemory(folder + "/state/patient.txt").remembered().path, "") << "nobody was there";
}

TEST_F(OccupancyRecords, ThatAreWrittenDownAlreadyNeedNoDisk) {
  const PatientMemory memory(folder + "/state/patient.txt");
  memory.remember({patient.path, "mark"});
  std::filesystem::create_hard_link(folder + "/state/patient.txt", folder + "/same");
  memory.remember({patient.path, "mark"});
  EXPECT_TRUE(std::filesystem::equivalent(folder + "/state/patient.txt", folder + "/same")) << "written anew";
  memory.remember({patient.path, "another"});
  EXPECT_FALSE(std::filesystem::equivalent(folder + "/state/patient.txt", folder + "/same"));
}

TEST_F(OccupancyRecords, AreNotChangedWhileTheMachineSaysWhyNot) {
  busy = "not possible while the robot is holding";
  const Answer refused = record.change(Occupancy::Empty, std::nullopt);
  EXPECT_FALSE(refused.ok);
  EXPECT_EQ(refused.sentence, busy);
  EXPECT_TRUE(told.empty());
}

TEST_F(OccupancyRecords, AreNotChangedByALookAtTheMachineThatIsOldWhenNothingCanBeAskedAnyMore) {
  // Drives are switched on between the first look and the moment from which nothing can be asked.
  int looks = 0;
  asked = [&] { busy = ++looks == 1 ? "" : "not possible while the robot is holding"; };
  const Answer refused = record.change(Occupancy::Empty, std::nullopt);
  EXPECT_FALSE(refused.ok);
  EXPECT_EQ(refused.sentence, "not possible while the robot is holding");
  EXPECT_TRUE(told.empty());
  const OccupancyRecord::Hold hold(record);
  EXPECT_TRUE(hold) << "the change is over";
}

TEST_F(OccupancyRecords, LetNothingBeAskedWhileTheyAreChanged) {
  bool last = true;
  asked = [&] { last = static_cast<bool>(OccupancyRecord::Hold(record)); };
  ASSERT_TRUE(record.change(Occupancy::Empty, std::nullopt).ok);
  EXPECT_FALSE(last) << "the machine is looked at when nothing can be asked of it any more";
}

TEST_F(OccupancyRecords, StayAsTheyAreWhileSomethingIsAskedOfTheMachine) {
  {
    const OccupancyRecord::Hold hold(record);
    ASSERT_TRUE(hold);
    EXPECT_FALSE(record.change(Occupancy::Empty, std::nullopt).ok);
  }
  EXPECT_TRUE(record.change(Occupancy::Empty, std::nullopt).ok);
}

TEST_F(OccupancyRecords, ThatCannotBeRememberedChangeNothing) {
  writeFileAtomically(folder + "/memory", "no folder\n");
  OccupancyRecord forgetful(
      PatientMemory(folder + "/memory/patient.txt"), [] { return ""; },
      [this](Occupancy now, const PatientRange&) { told.push_back(now); });
  const Answer refused = forgetful.change(Occupancy::Patient, patient);
  EXPECT_FALSE(refused.ok);
  EXPECT_NE(refused.sentence.find("cannot be remembered"), std::string::npos) << refused.sentence;
  EXPECT_TRUE(told.empty());
  EXPECT_FALSE(forgetful.patient());
  const OccupancyRecord::Hold hold(forgetful);
  EXPECT_TRUE(hold) << "the change is over";
}

constexpr char kNarrow[] =
    "patient: \"17\"\npose: {X_m: [-0.1, 0.1], Z_m: [0.58, 0.68], theta_deg: [-10, 10], psi_deg: [-10, 10]}\n";
constexpr char kWider[] =
    "patient: \"17\"\npose: {X_m: [-0.1, 0.1], Z_m: [0.50, 0.75], theta_deg: [-20, 20], psi_deg: [-10, 10]}\n";

Answer everybody(const PatientLimits&) {
  return {true, ""};
}

TEST_F(OccupancyRecords, DoNotTakeAFileThatChangedWhileItWasLoadedForTheOneThatWasLoaded) {
  const mechanism::Robot robot = mechanism::configuredRobot("A");
  const PatientMemory memory(folder + "/patient.txt");
  const auto ignore = [](Occupancy, const PatientRange&) {};
  writeFileAtomically(patient.path, kNarrow);
  {
    const PatientLimits loaded = loadPatientLimits(patient.path, robot);
    writeFileAtomically(patient.path, kWider);  // between the limits that hold now and what is remembered of them
    OccupancyRecord first(
        memory, [] { return ""; }, ignore);
    ASSERT_TRUE(first.change(Occupancy::Patient, loaded).ok);
  }
  OccupancyRecord second(
      memory, [] { return ""; }, ignore);
  second.recall(robot, true, everybody);
  EXPECT_FALSE(second.patient()) << "nobody has ever loaded the limits that the file has now";
  EXPECT_NE(second.whyNobodyMoves().find("is not what it was"), std::string::npos) << second.whyNobodyMoves();
  writeFileAtomically(patient.path, kNarrow);
  OccupancyRecord third(
      memory, [] { return ""; }, ignore);
  third.recall(robot, true, everybody);
  ASSERT_TRUE(third.patient()) << third.whyNobodyMoves();
  EXPECT_EQ(third.patient()->name, "17");
  OccupancyRecord fourth(
      memory, [] { return ""; }, ignore);
  fourth.recall(robot, true, [](const PatientLimits&) { return Answer{false, "no guardian watches"}; });
  EXPECT_FALSE(fourth.patient()) << "the machine is not what it was when this patient was loaded";
  EXPECT_NE(fourth.whyNobodyMoves().find("no guardian watches"), std::string::npos) << fourth.whyNobodyMoves();
}

TEST_F(OccupancyRecords, DoNotTakeAMemoryWithoutContentForNobody) {
  const mechanism::Robot robot = mechanism::configuredRobot("A");
  writeFileAtomically(folder + "/patient.txt", "");
  OccupancyRecord begun(
      PatientMemory(folder + "/patient.txt"), [] { return ""; }, [](Occupancy, const PatientRange&) {});
  begun.recall(robot, true, everybody);
  EXPECT_EQ(begun.occupancy(), Occupancy::Unknown);
  EXPECT_NE(begun.whyNobodyMoves().find("does not say which patient"), std::string::npos) << begun.whyNobodyMoves();
}

}  // namespace
}  // namespace knee_robot::control
