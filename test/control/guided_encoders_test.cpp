// Encoders that die while a hand guides the platform: its reference is where it is, so no follower sees an error.
#include "guided_robot.h"

namespace knee_robot::control {
namespace {

using namespace guided;

/// How far the platform gets from where it was when the encoders of `axes` died.
double blindWay(guided::Rig& rig, unsigned axes, const std::string& expected) {
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    if ((axes >> i & 1u) != 0)
      rig.image.faults.encoder[i].store(static_cast<std::uint8_t>(simulation::EncoderFault::Frozen));
  }
  rig.watch();
  for (int k = 0; k < 4000 && rig.system->state() == MachineState::Guiding; ++k)
    rig.system->step();
  rig.system->run(0.5);
  const ControlStatus status = rig.system->status();
  EXPECT_TRUE(expected.find(status.fault_name) != std::string::npos && !status.fault_name.empty())
      << "'" << status.fault_name << "'";
  return rig.farthest;
}

TEST(GuidedEncoders, FindsADeadEncoderAndTheLossOfAllOfThemWhileTheHandMovesThePlatform) {
  for (const unsigned axes : {1u, 2u, 4u, 8u, 3u, 15u}) {
    guided::Rig rig;
    ASSERT_NO_FATAL_FAILURE(rig.begin());
    rig.swing(1, 0.08, 0.03);
    rig.system->run(1.2);
    ASSERT_EQ(rig.system->state(), MachineState::Guiding);
    const double way = blindWay(rig, axes, "encoder_frozen axis_blocked");
    std::printf("encoders %2u: %.1f mm\n", axes, 1e3 * way);
    EXPECT_LT(way, axes == 15u ? 0.03 : 0.005) << "axes " << axes;
  }
}

TEST(GuidedEncoders, FindsTheLossOfAllEncodersWhileNobodyMovesThePlatformAndWhenAHandBeginsTo) {
  for (const bool moves : {false, true}) {
    guided::Rig rig;
    ASSERT_NO_FATAL_FAILURE(rig.begin());
    rig.system->run(1.0);
    ASSERT_EQ(rig.system->state(), MachineState::Guiding);
    if (moves) rig.swing(1, 0.08, 0.03);
    const double way = blindWay(rig, 15u, "encoder_frozen axis_blocked");
    std::printf("%s: %.1f mm\n", moves ? "a hand begins to move it" : "nobody moves it", 1e3 * way);
    EXPECT_LT(way, 0.03);
  }
}

TEST(GuidedEncoders, AsksTheEncodersOfAPlatformThatNobodyTouchesWithoutCarryingItAway) {
  guided::Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.begin());
  rig.system->run(60.0);
  std::printf("%.1f mm in 60 s\n", 1e3 * rig.farthest);
  EXPECT_EQ(rig.system->state(), MachineState::Guiding);
  EXPECT_LT(rig.farthest, 0.005);
}

TEST(GuidedDrives, ThatTurnRoundEndTheGuidingBeforeThePlatformHasSunkByHalfADecimetre) {
  for (std::size_t axis = 0; axis < hardware::kAxes; ++axis) {
    guided::Rig rig;
    ASSERT_NO_FATAL_FAILURE(rig.begin());
    rig.system->run(0.5);
    rig.watch();
    rig.image.faults.drive_reversed.store(static_cast<std::uint8_t>(1u << axis));
    rig.system->waitFor(MachineState::Faulted, 3.0);
    std::printf("drive %zu: %.1f mm, %s\n", axis + 1, 1e3 * rig.farthest, rig.system->status().fault_name.c_str());
    // Drive 1 gives little at this pose: the platform creeps, slower than a hand would move it.
    const std::string fault = rig.system->status().fault_name;
    EXPECT_TRUE(fault == "runaway" || axis == 0) << fault;
    EXPECT_LT(rig.farthest, 0.05) << "axis " << axis + 1;  // once 130 mm of leg 4
  }
}

/// How far the end of the saved path is from where the hand has left the platform, by the lengths of each time, m; < 0:
/// there is no path.
double savedBeside(guided::Rig& rig, const mechanism::Lengths& left_m) {
  const std::string path = temporary("guided_beside.txt");
  const Answer saved = rig.system->saveGuided(path);
  if (!saved.ok) return -1.0;
  const trajectory::Points points = trajectory::readReference(path).points;
  std::remove(path.c_str());
  return (points.row(points.rows() - 1).transpose() - left_m).cwiseAbs().maxCoeff();
}

mechanism::Lengths measured(const guided::Rig& rig) {
  return mechanism::Lengths(rig.system->snapshot()->position_m.data());
}

/// The faults are gone, somebody resets and takes this place for home.
void homeHere(guided::Rig& rig) {
  rig.letGo();
  rig.hold(false);
  rig.system->run(0.5);
  simulation::clear(rig.image.faults);
  rig.system->run(0.1);
  ASSERT_TRUE(rig.system->resetFaults().ok);
  const Answer homed = rig.system->home();
  ASSERT_TRUE(homed.ok) << homed.sentence;
  rig.system->run(0.1);
}

TEST(GuidedPaths, AreNotSavedByTheLengthsOfAHomeThatWasLost) {
  guided::Rig rig;
  ASSERT_NO_FATAL_FAILURE(rig.begin());
  rig.swing(1, 0.03, 0.03);
  rig.system->run(1.5);
  for (auto& encoder : rig.image.faults.encoder)
    encoder.store(static_cast<std::uint8_t>(simulation::EncoderFault::Interrupted));
  ASSERT_TRUE(rig.system->waitFor(MachineState::Faulted, 5.0));
  ASSERT_NO_FATAL_FAILURE(homeHere(rig));
  const double beside_m = savedBeside(rig, measured(rig));
  EXPECT_LT(beside_m, 0.001) << "the saved path ends " << 1e3 * beside_m << " mm from where the platform was left";
}

TEST(GuidedPaths, HoldNothingThatAnEncoderSaidWhenItJumped) {
  for (int ms = 0; ms < 10; ++ms) {  // a sample is taken every 10 ms
    guided::Rig rig;
    ASSERT_NO_FATAL_FAILURE(rig.begin());
    rig.swing(1, 0.03, 0.03);
    rig.system->run(1.5 + 1e-3 * ms);
    const mechanism::Lengths left = measured(rig);
    rig.image.faults.encoder_size_m[0].store(0.018);
    rig.image.faults.encoder[0].store(static_cast<std::uint8_t>(simulation::EncoderFault::Jump));
    ASSERT_TRUE(rig.system->waitFor(MachineState::Faulted, 3.0));
    const double beside_m = savedBeside(rig, left);
    EXPECT_LT(beside_m, 0.002) << ms << ": ends " << 1e3 * beside_m << " mm beside";
  }
}

}  // namespace
}  // namespace knee_robot::control
