// The last seconds of all signals, on every fault, readable by the same tools.
#include <gtest/gtest.h>

#include <filesystem>

#include "../../src/control/black_box_writer.h"
#include "knee_robot/base/files.h"
#include "knee_robot/recording/recording.h"
#include "system_rig.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

using fake::Rig;

class BlackBoxTest : public ::testing::Test {
 protected:
  std::vector<std::string> dumps() const {
    std::vector<std::string> all;
    if (!std::filesystem::exists(folder + "/box")) return all;
    for (const auto& entry : std::filesystem::directory_iterator(folder + "/box")) {
      if (entry.path().extension() == ".csv") all.push_back(entry.path().string());
    }
    return all;
  }
  const TemporaryFolder folder;
};

struct BoxedRig : Rig {
  explicit BoxedRig(const std::string& folder) : fake::Rig(fake::hardware(), folder) {}
};

TEST_F(BlackBoxTest, KeepsFiveSecondsBeforeTheFaultAndWhatFollowed) {
  BoxedRig rig(folder + "/box");
  ASSERT_NO_FATAL_FAILURE(rig.play());
  rig.system.run(4.0);
  ASSERT_TRUE(dumps().empty()) << "nothing without a fault";
  rig.machine.axes[1].encoder_offset_m = 0.01;
  ASSERT_TRUE(rig.system.waitFor(MachineState::Faulted, 2.0));
  rig.system.run(1.0);
  const std::string path = rig.system.status().black_box;
  ASSERT_EQ(dumps(), std::vector<std::string>{path});
  EXPECT_NE(path.find("encoder_jump.csv"), std::string::npos) << path;
  const recording::Recording recording = recording::loadRecording(path);
  EXPECT_EQ(recording.rows(), 5500);
  const std::string text = readFile(path);
  EXPECT_NE(text.substr(0, text.find('\n')).find("drive_level"), std::string::npos);
  const std::string sidecar = readFile(path.substr(0, path.size() - 4) + ".yaml");
  EXPECT_NE(sidecar.find("fault: encoder_jump"), std::string::npos);
  EXPECT_NE(sidecar.find("axis: 2"), std::string::npos);
  EXPECT_NE(sidecar.find("homing, guiding]"), std::string::npos) << "all states, in the order of their numbers";
}

TEST_F(BlackBoxTest, WritesEveryFaultEvenWhenTheyFollowOneAnother) {
  BoxedRig rig(folder + "/box");
  ASSERT_NO_FATAL_FAILURE(rig.hold());
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(rig.system.emergencyStop().ok);
    ASSERT_TRUE(rig.system.waitFor(MachineState::Faulted, 2.0));
    ASSERT_TRUE(rig.system.resetFaults().ok);
    ASSERT_TRUE(rig.system.enable().ok);
    rig.system.run(1.0);
  }
  EXPECT_EQ(dumps().size(), 3u);
}

TEST_F(BlackBoxTest, WritesAFaultThatShutdownFollowsAtOnce) {
  {
    BoxedRig rig(folder + "/box");
    ASSERT_NO_FATAL_FAILURE(rig.hold());
    ASSERT_TRUE(rig.system.emergencyStop().ok);
    rig.system.run(0.01);
    (void)rig.system.shutdown();
  }
  ASSERT_EQ(dumps().size(), 1u);
  EXPECT_GT(recording::loadRecording(dumps()[0]).rows(), 100);
}

/// A black box of ten rows that is told of faults, and no robot.
struct FedBox : rt::TaskContext {
  FedBox() : rt::TaskContext("BlackBoxFeed") {
    rt::connect(status, box.status);
    box.rows.set(10);
    box.rows_after.set(0);
    EXPECT_TRUE(box.configure() && box.start());
  }
  void faultComes() {
    SupervisorStatus now;
    for (const Fault fault : {Fault::None, Fault::EmergencyStop}) {
      now.fault = fault;
      status.write(now);
      cycle.time += 1'000'000;
      box.update(cycle);
    }
  }
  rt::OutputPort<SupervisorStatus> status{*this, "status", ""};
  BlackBox box{"BlackBox"};
  rt::Cycle cycle;
};

TEST_F(BlackBoxTest, SaysThatFaultsCameFasterThanTheDiskTookThem) {
  FedBox fed;
  BlackBoxWriter writer(fed.box, folder + "/box", false);
  fed.faultComes();
  fed.faultComes();
  EXPECT_EQ(writer.error(), "");
  fed.faultComes();
  EXPECT_NE(writer.error().find("1 faults were lost"), std::string::npos) << writer.error();
  writer.write();
  writer.write();
  EXPECT_EQ(dumps().size(), 2u);
  EXPECT_NE(writer.error(), "") << "they stay lost";
}

TEST_F(BlackBoxTest, LeavesTheLastRoomOnADiskToOthers) {
  FedBox fed;
  BlackBoxWriter writer(fed.box, folder + "/box", false, UINTMAX_MAX);
  fed.faultComes();
  writer.write();
  EXPECT_TRUE(dumps().empty());
  EXPECT_NE(writer.error().find("MB are left on this disk"), std::string::npos) << writer.error();
}

TEST_F(BlackBoxTest, SaysThatTheDiskRefusedAndGoesOn) {
  writeFileAtomically(folder + "/box", "a file where a folder should be");
  BoxedRig rig(folder + "/box");
  ASSERT_NO_FATAL_FAILURE(rig.hold());
  ASSERT_TRUE(rig.system.emergencyStop().ok);
  ASSERT_TRUE(rig.system.waitFor(MachineState::Faulted, 2.0));
  rig.system.run(1.0);
  EXPECT_NE(rig.system.status().black_box_error, "");
  EXPECT_EQ(rig.system.status().black_box, "");
  EXPECT_TRUE(rig.system.resetFaults().ok);
}

}  // namespace
}  // namespace knee_robot::control
