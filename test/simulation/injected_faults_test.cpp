// Faults that the simulated robot applies to its own registers: what a controller would meet on a real machine.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "knee_robot/hardware/pci1720_registers.h"
#include "knee_robot/simulation/robot_simulation.h"

namespace knee_robot::simulation {
namespace {

constexpr double kStep = 0.001;
constexpr std::uint8_t kPower = 3;  // drive_enable and hold_release of config/simulation/A.yaml

class InjectedFaultsTest : public testing::Test {
 protected:
  void make() {
    simulation_ = std::make_unique<RobotSimulation>(robot_, dynamics::loadRobotInertia(robot_), parameters_, *image_);
  }
  void powerUp() {
    image_->counter.outputs.store(kPower);
    setCode(0x800);
    run(0.1);
  }
  void setCode(std::uint64_t code) {
    std::uint64_t word = 0xFFull << 48;
    for (int c = 0; c < 4; ++c)
      word |= code << (12 * c);
    image_->analog.converters.store(word);
  }
  void run(double seconds) {
    for (double t = 0.0; t < seconds - 0.5 * kStep; t += kStep)
      ASSERT_TRUE(simulation_->step(kStep));
  }
  std::int32_t count(std::size_t axis) const {
    return static_cast<std::int32_t>(publishedCounts(image_->counter)[axis]);
  }
  void order(EncoderFault fault, std::size_t axis, double size = 0.0) {
    image_->faults.encoder_size_m[axis].store(size);
    image_->faults.encoder[axis].store(static_cast<std::uint8_t>(fault));
  }
  double trueCount(std::size_t axis) const {
    const mechanism::Actuator& actuator = robot_.actuators[axis];
    return (simulation_->truth().length_m[axis] - actuator.home_length_m) / actuator.metresPerCount();
  }

  const mechanism::Robot robot_ = mechanism::loadRobot(KNEE_SOURCE_DIR "/config/robots/A.yaml");
  SimulationParameters parameters_ = loadSimulationParameters(KNEE_SOURCE_DIR "/config/simulation/A.yaml");
  std::unique_ptr<RobotImage> image_ = std::make_unique<RobotImage>();
  std::unique_ptr<RobotSimulation> simulation_;
};

TEST_F(InjectedFaultsTest, aFrozenEncoderStaysWhileTheOthersCountAndComesBackWithTheTruth) {
  make();
  powerUp();
  order(EncoderFault::Frozen, 0);
  run(kStep);
  const std::int32_t frozen = count(0);
  const std::int32_t other = count(1);
  run(0.2);  // nothing carries the platform
  EXPECT_EQ(count(0), frozen);
  EXPECT_NE(count(1), other);
  order(EncoderFault::None, 0);
  run(kStep);
  EXPECT_NEAR(count(0), trueCount(0), 1.0);
}

TEST_F(InjectedFaultsTest, anInterruptedEncoderCountsOnFromWhereItStoodAndWhatItMissedStaysMissed) {
  make();
  powerUp();
  order(EncoderFault::Interrupted, 0);
  run(kStep);
  const std::int32_t stood = count(0);
  run(0.2);  // nothing carries the platform
  EXPECT_EQ(count(0), stood);
  order(EncoderFault::None, 0);
  run(kStep);
  const double missed = trueCount(0) - count(0);
  EXPECT_GT(std::abs(missed), 10.0);
  run(0.1);
  EXPECT_NE(count(0), stood);
  EXPECT_NEAR(trueCount(0) - count(0), missed, 1.0);
}

TEST_F(InjectedFaultsTest, aJumpIsOfTheOrderedSizeAndAWrongSignMirrorsTheMotionFromWhereItCame) {
  make();
  powerUp();
  order(EncoderFault::Jump, 1, 0.002);
  run(kStep);
  EXPECT_NEAR(count(1) - trueCount(1), 0.002 / robot_.actuators[1].metresPerCount(), 1.0);
  order(EncoderFault::WrongSign, 2);
  run(kStep);
  const double onset = trueCount(2);
  run(0.2);
  EXPECT_GT(std::abs(trueCount(2) - onset), 10.0);
  EXPECT_NEAR(count(2) - onset, onset - trueCount(2), 2.0);
}

TEST_F(InjectedFaultsTest, noiseStaysWithinItsSizeAndADisconnectedEncoderDithersByTwoCounts) {
  make();
  run(kStep);
  order(EncoderFault::Noise, 0, 0.001);
  order(EncoderFault::Disconnected, 3);
  const double bound = 0.001 / robot_.actuators[0].metresPerCount() + 1.0;
  double largest = 0.0;
  int changes = 0;
  std::int32_t last = count(3);
  const std::int32_t onset = last;
  for (int i = 0; i < 500; ++i) {
    run(kStep);
    largest = std::max(largest, std::abs(count(0) - trueCount(0)));
    changes += count(3) != last;
    last = count(3);
    EXPECT_LE(std::abs(last - onset), 3);
  }
  EXPECT_LT(largest, bound);
  EXPECT_GT(largest, 0.8 * bound);
  EXPECT_GT(changes, 100);
}

TEST_F(InjectedFaultsTest, aStuckConverterKeepsItsVoltageWhateverIsWritten) {
  make();
  powerUp();
  setCode(0x900);
  run(kStep);
  const double volts = simulation_->truth().volts[0];
  image_->faults.converter_stuck.store(1);
  run(kStep);
  setCode(0x700);
  run(0.01);
  EXPECT_EQ(simulation_->truth().volts[0], volts);
  EXPECT_LT(simulation_->truth().volts[1], 0.0);
}

TEST_F(InjectedFaultsTest, aDeadDriveGivesNoForceAndAReversedOneTheOppositeForce) {
  make();
  powerUp();
  setCode(0x900);
  run(kStep);
  const TruthRow good = simulation_->truth();
  image_->faults.drive_dead.store(1);
  image_->faults.drive_reversed.store(2);
  run(kStep);
  const TruthRow row = simulation_->truth();
  EXPECT_EQ(row.force_N[0], 0.0);
  EXPECT_EQ(row.drives, 0xEu);
  EXPECT_EQ(row.force_N[1], -good.force_N[1]);
  EXPECT_EQ(row.force_N[2], good.force_N[2]);
}

TEST_F(InjectedFaultsTest, aWeakDriveGivesHalfOfTheForceAndALateOneNoneForATenthOfASecond) {
  make();
  image_->faults.drive_late.store(4);
  image_->faults.drive_weak.store(2);
  image_->counter.outputs.store(kPower);
  setCode(0x900);
  run(0.05);
  EXPECT_EQ(simulation_->truth().drives, 0xBu);
  EXPECT_EQ(simulation_->truth().force_N[1], 0.5 * simulation_->truth().force_N[0]);
  run(0.1);
  EXPECT_EQ(simulation_->truth().drives, 0xFu);
  EXPECT_EQ(simulation_->truth().force_N[2], simulation_->truth().force_N[0]);
}

TEST_F(InjectedFaultsTest, aLateHoldDeviceEngagesHalfASecondLaterAndACreepingOneLetsThePlatformSinkSlowly) {
  make();
  run(0.2);
  image_->counter.outputs.store(kPower);
  run(0.1);
  image_->faults.hold_late.store(8);
  image_->counter.outputs.store(0);
  run(0.2);
  EXPECT_EQ(simulation_->truth().holds, 7u);
  run(0.4);
  EXPECT_EQ(simulation_->truth().holds, 0xFu);
  const double held = simulation_->truth().pose[1];
  image_->faults.hold_creeps.store(0xF);
  run(1.0);
  EXPECT_LT(simulation_->truth().pose[1], held - 0.0003);
  EXPECT_GT(simulation_->truth().pose[1], held - 0.01);
}

TEST_F(InjectedFaultsTest, holdDevicesThatDoNotEngageLetThePlatformFallAndClosedOnesDoNotOpen) {
  make();
  run(0.2);
  const double held = simulation_->truth().pose[1];
  run(0.2);
  EXPECT_NEAR(simulation_->truth().pose[1], held, 1e-9);
  image_->faults.hold_open.store(0xF);
  run(0.3);
  EXPECT_EQ(simulation_->truth().holds, 0u);
  EXPECT_LT(simulation_->truth().pose[1], held - 0.005);
  image_->faults.hold_open.store(0);
  image_->faults.hold_closed.store(4);
  image_->counter.outputs.store(kPower);
  run(0.2);
  EXPECT_EQ(simulation_->truth().holds, 4u);
}

TEST_F(InjectedFaultsTest, theHeartbeatRelayTakesThePowerWhenTheOutputStandsStill) {
  parameters_.heartbeat_relay = HeartbeatRelay{2, 0.02};
  make();
  for (int i = 0; i < 100; ++i) {
    image_->counter.outputs.store(static_cast<std::uint8_t>(kPower | (i % 2 == 0 ? 4 : 0)));
    run(kStep);
  }
  EXPECT_EQ(simulation_->truth().drives, 0xFu);
  EXPECT_EQ(simulation_->truth().holds, 0u);
  run(0.025);
  EXPECT_EQ(simulation_->truth().drives, 0u);
  run(0.05);
  EXPECT_EQ(simulation_->truth().holds, 0xFu);
}

TEST_F(InjectedFaultsTest, theHandSwitchAndReadyDrivesAreReadOnInputsOfTheirOwn) {
  make();
  run(kStep);
  EXPECT_EQ(image_->counter.inputs.load(), 7u);
  image_->surroundings.hand_switch_pressed.store(1);
  run(kStep);
  EXPECT_EQ(image_->counter.inputs.load(), 5u);
  image_->faults.drive_dead.store(4);
  run(kStep);
  EXPECT_EQ(image_->counter.inputs.load(), 1u);
}

}  // namespace
}  // namespace knee_robot::simulation
