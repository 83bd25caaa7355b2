// Nothing allocates in any updateHook, whatever happens: operator new counts while a hook runs.
#include <gtest/gtest.h>

#include "system_rig.h"
#include "test/allocation_guard.h"
#include "test/temporary_folder.h"

namespace knee_robot::control {
namespace {

using fake::kHome;
using fake::Rig;

/// Arms the count around every updateHook of `rig` and remembers which components were watched.
struct Guard {
  explicit Guard(Rig& rig) : rig_(rig) {
    allocations = 0;
    rig.injection.around = [this](const std::string& name, bool begins) {
      if (begins) {
        ++updates_[index(name)];
        armed = true;
      } else {
        armed = false;
      }
    };
  }
  ~Guard() {
    armed = false;
    rig_.injection.around = nullptr;
  }
  std::size_t index(const std::string& name) {
    const auto& all = rig_.system.deployment().components();
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i]->name() == name) return i;
    }
    return updates_.size() - 1;
  }
  bool everyComponentRan() const {
    for (std::size_t i = 0; i < rig_.system.deployment().components().size(); ++i) {
      if (updates_[i] == 0) return false;
    }
    return true;
  }
  std::array<int, 32> updates_{};
  Rig& rig_;
};

TEST(AllocationGuard, CountsWhatItIsMeantToCount) {
  armed = true;
  for (int i = 0; i < 2; ++i)
    operator delete(operator new(8));  // a new expression may be optimised away
  armed = false;
  EXPECT_GE(allocations, 4);
}

TEST(AllocationGuard, FindsNoneFromEnablingToPlayingToTheSafeStop) {
  Rig rig;
  ASSERT_TRUE(rig.system.start().ok);
  Guard guard(rig);
  ASSERT_TRUE(rig.system.enable().ok);
  rig.system.run(1.0);
  ASSERT_TRUE(rig.system.loadReference(fake::smoothReference(fake::kHome, 0.03, 2.0)).ok);
  ASSERT_TRUE(rig.system.play().ok);
  rig.system.run(0.5);
  ASSERT_TRUE(rig.system.stop().ok);
  rig.system.run(0.5);
  EXPECT_FALSE(rig.system.play().ok) << "a refusal, too";
  ASSERT_TRUE(rig.system.disable().ok);
  EXPECT_TRUE(guard.everyComponentRan());
  EXPECT_EQ(allocations, 0);
}

TEST(AllocationGuard, FindsNoneOnTheRoadsOfFaults) {
  for (const char* silent : {"Sync", "Driver2", "AxesInput", "Supervisor", "Monitors"}) {
    Rig rig;
    ASSERT_NO_FATAL_FAILURE(rig.play());
    Guard guard(rig);
    rig.injection.silent = silent;
    rig.system.run(1.0);
    EXPECT_EQ(allocations, 0) << silent;
  }
  Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.play());
  Guard guard(rig);
  rig.machine.read_status = hardware::IoStatus::Disconnected;
  rig.machine.volts_status = hardware::IoStatus::Disconnected;
  rig.system.run(1.0);
  EXPECT_EQ(allocations, 0);
}

TEST(AllocationGuard, FindsNoneInMonitorsThatFindAFaultAndInTheBlackBoxThatHandsItOver) {
  for (int kind = 0; kind < 5; ++kind) {
    Rig rig;
    ASSERT_NO_FATAL_FAILURE(rig.play());
    Guard guard(rig);
    rig.machine.axes[0].encoder_frozen = kind == 0;
    rig.machine.axes[1].encoder_offset_m = kind == 1 ? 0.02 : 0.0;
    rig.machine.axes[2].drive_dead = kind == 2;
    rig.machine.axes[3].wrong_sign = kind == 3;
    rig.machine.axes[0].push_N = kind == 4 ? 800.0 : 0.0;
    rig.system.run(2.0);
    EXPECT_EQ(rig.system.state(), MachineState::Faulted) << kind;
    EXPECT_TRUE(guard.everyComponentRan());
    EXPECT_EQ(allocations, 0) << kind;
  }
}

TEST(AllocationGuard, FindsNoneWhilePausingAndScaling) {
  Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.play());
  Guard guard(rig);
  ASSERT_TRUE(rig.system.pause().ok);
  rig.system.run(0.5);
  ASSERT_TRUE(rig.system.setSpeed(30.0).ok);
  ASSERT_TRUE(rig.system.setProperty("Driver2", "integral_N_per_m_s", "100000").ok);
  ASSERT_TRUE(rig.system.resume().ok);
  rig.system.run(1.0);
  EXPECT_EQ(allocations, 0);
}

TEST(AllocationGuard, FindsNoneWhileHoming) {
  HardwareFile hardware = fake::hardware();
  hardware.homing.method = HomingMethod::HardStop;
  HomingAxis axis;
  axis.length_m = 0.59;
  axis.speed_m_per_s = 0.02;
  axis.force_N = 150.0;
  hardware.homing.axes.fill(axis);
  Rig rig(hardware);
  for (auto& one : rig.machine.axes)
    one.stop_min = 0.59;
  ASSERT_TRUE(rig.system.start().ok);
  Guard guard(rig);
  ASSERT_TRUE(rig.system.home().ok);
  EXPECT_TRUE(rig.system.waitFor(MachineState::Disabled, 30.0)) << rig.system.status().fault_sentence;
  EXPECT_EQ(allocations, 0);
}

TEST(AllocationGuard, FindsNoneWhileTheRecorderRuns) {
  Rig rig;
  rig.hold();
  const TemporaryFolder folder;
  ASSERT_TRUE(rig.system.startRecording(folder + "/r.csv").ok);
  {
    Guard guard(rig);
    rig.system.run(0.5);
  }
  EXPECT_EQ(allocations, 0);
  EXPECT_TRUE(rig.system.stopRecording().ok);
}

}  // namespace
}  // namespace knee_robot::control
