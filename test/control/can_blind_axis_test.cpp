// Drives on CAN: an encoder that dies at rest and in motion, a brake that closes. Feedback is a servo period of 2 ms
// old there.
#include <gtest/gtest.h>

#include <algorithm>

#include "test/control/can_rig.h"

namespace knee_robot::fake {
namespace {

struct Found {
  std::string fault;
  int axis = 0;
  double drop_m = 0.0;
};

Found lookOn(CanRig& rig, double seconds) {
  const double height = rig.image.status.pose[1].load();
  double lowest = height;
  for (int k = 0; k < static_cast<int>(500 * seconds) && rig.system.state() != control::MachineState::Faulted; ++k) {
    rig.system.step();
    lowest = std::min(lowest, rig.image.status.pose[1].load());
  }
  const control::ControlStatus status = rig.system.status();
  return {status.fault_name, status.fault_axis, height - lowest};
}

void freeze(CanRig& rig, std::size_t axis) {
  rig.image.faults.encoder[axis].store(static_cast<std::uint8_t>(simulation::EncoderFault::Frozen));
}

TEST(CanBlindAxis, APushOf150NewtonFindsAnyDeadEncoderAtRestBeforeThePlatformHasSunkBy5Millimetres) {
  for (std::size_t axis = 0; axis < hardware::kAxes; ++axis) {
    CanRig rig;
    ASSERT_TRUE(rig.hold().ok);
    rig.system.run(3.0);
    freeze(rig, axis);
    rig.system.run(1.0);
    rig.image.surroundings.pose_force[1].store(-150.0);
    const Found found = lookOn(rig, 3.0);
    EXPECT_EQ(found.axis, static_cast<int>(axis) + 1) << found.fault;
    EXPECT_TRUE(found.fault == "encoder_frozen" || found.fault == "axis_blocked") << found.fault;
    EXPECT_LT(found.drop_m, 0.005) << "axis " << axis + 1;
  }
}

TEST(CanBlindAxis, AnEncoderThatDiesInMotionIsFoundAndNamed) {
  for (std::size_t axis = 0; axis < hardware::kAxes; ++axis) {
    CanRig rig;
    ASSERT_TRUE(rig.play().ok);
    freeze(rig, axis);
    const Found found = lookOn(rig, 3.0);
    EXPECT_EQ(found.axis, static_cast<int>(axis) + 1) << found.fault;
    EXPECT_EQ(found.fault, "encoder_frozen") << "axis " << axis + 1;
    EXPECT_LT(found.drop_m, 0.005) << "axis " << axis + 1;
  }
}

TEST(CanBlindAxis, NobodyIsShakenByAMillimetreWhileNothingHappens) {
  CanRig rig;
  ASSERT_TRUE(rig.hold().ok);
  rig.system.run(3.0);
  const double height = rig.image.status.pose[1].load();
  double farthest = 0.0;
  for (int k = 0; k < 5000; ++k) {
    rig.system.step();
    farthest = std::max(farthest, std::abs(rig.image.status.pose[1].load() - height));
  }
  std::printf("farthest from where it stood in 10 s: %.2f mm\n", 1e3 * farthest);
  EXPECT_LT(farthest, 1e-3);
  EXPECT_EQ(rig.system.state(), control::MachineState::Holding) << rig.system.status().fault_sentence;
}

}  // namespace
}  // namespace knee_robot::fake
