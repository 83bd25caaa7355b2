#include "knee_robot/simulation/robot_simulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "knee_robot/base/errors.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "test/refusal.h"
#include "test/simulation/plant_bench.h"

namespace knee_robot::simulation {
namespace {

constexpr std::uint8_t kDrives = 1;
constexpr std::uint8_t kRelease = 2;
constexpr double kStep_s = 1e-3;

const char* const kText = R"(
start_lengths_m: [0.6576, 0.6990, 0.7091, 0.6671]
axes: [{viscous_N_s_per_m: 150, coulomb_N: 15, hold_device: HOLD, holding_force_N: 1500}]
)";

SimulationParameters parametersWith(const std::string& hold, const std::string& more = "") {
  std::string text = kText;
  text.replace(text.find("HOLD"), 4, hold);
  return parseSimulationParameters(text + more, "test.yaml");
}

/// Robot A in process, and a controller's handle to its cards.
struct Rig {
  explicit Rig(const SimulationParameters& parameters, const mechanism::Robot& used = configuredRobot("A"))
      : robot(used),
        simulation(robot, dynamics::loadRobotInertia(robot), parameters, image),
        bus(openImageCards(image)) {
    if (!bus->selfTest().passed) throw std::runtime_error("self test");
  }
  void run(double seconds) {
    for (int i = 0; i < std::lround(seconds / kStep_s); ++i)
      ASSERT_TRUE(simulation.step(kStep_s));
  }
  hardware::AxisFeedback read() {
    hardware::AxisFeedback feedback;
    EXPECT_EQ(bus->read(feedback), hardware::IoStatus::Ok);
    return feedback;
  }
  /// Writes these forces (N) as volts.
  void push(const mechanism::Vector4& forces) {
    std::array<double, 4> volts{}, written{};
    for (int i = 0; i < 4; ++i) {
      const mechanism::Actuator& actuator = robot.actuators[static_cast<std::size_t>(i)];
      volts[static_cast<std::size_t>(i)] = forces[i] / (actuator.force_sign * actuator.force_per_volt_N);
    }
    ASSERT_EQ(bus->writeVolts(volts, written), hardware::IoStatus::Ok);
  }
  mechanism::Vector4 holding() const { return holdingForces(simulation.model(), simulation.state().pose); }

  RobotImage image;
  mechanism::Robot robot;
  RobotSimulation simulation;
  std::unique_ptr<hardware::AxisBus> bus;
};

TEST(RobotSimulation, IsHeldByItsBrakesToTheLastBit) {
  Rig rig(parametersWith("brake"));
  const mechanism::Pose start = rig.simulation.state().pose;
  rig.run(10.0);
  EXPECT_EQ(rig.simulation.state().pose, start);
  for (const std::int32_t count : rig.read().counts)
    EXPECT_EQ(count, 0);
}

TEST(RobotSimulation, FallsWithoutAHoldDeviceAndSinksSlowlyWithShortedWindings) {
  Rig open(parametersWith("none"));
  Rig shorted(parametersWith("shorted_windings"));
  const double start = open.simulation.state().pose[1];
  double fallen_at = 0.0;
  for (int i = 0; i < 400 && fallen_at == 0.0; ++i) {
    open.run(kStep_s);
    if (start - open.simulation.state().pose[1] > 0.1) fallen_at = open.simulation.time();
  }
  shorted.run(fallen_at);
  const double sunk = start - shorted.simulation.state().pose[1];
  std::printf("100 mm of free fall after %.3f s; with shorted windings %.1f mm in that time\n", fallen_at, 1000 * sunk);
  EXPECT_GT(fallen_at, 0.14);  // sqrt(2 h / g) = 0.143 s without friction and rotors
  // Sinking is creeping: each axis at the speed at which its damping carries what its Coulomb friction leaves of the
  // load.
  const mechanism::Vector4 load = shorted.holding();
  const mechanism::Vector4 rate = mechanism::lengthJacobian(*shorted.robot.mechanism, shorted.simulation.state().pose) *
                                  shorted.simulation.state().pose_velocity;
  for (int axis = 0; axis < 4; ++axis) {
    const double expected = -std::copysign(std::max(0.0, std::abs(load[axis]) - 15.0), load[axis]) / (150.0 + 1240.0);
    EXPECT_NEAR(rate[axis], expected, 0.05 * load.cwiseAbs().maxCoeff() / 1390.0) << axis;
  }
  EXPECT_GT(sunk, 0.0);
}

TEST(RobotSimulation, FollowsVoltsOnlyWhileTheDrivesAreEnabledAndTheirDelayIsOver) {
  Rig rig(parametersWith("brake"));
  rig.push({50, 50, 50, 200});
  rig.run(0.05);
  EXPECT_EQ(rig.simulation.loads().motor_force, mechanism::Vector4(mechanism::Vector4::Zero()));
  ASSERT_EQ(rig.bus->writeOutputs(kDrives), hardware::IoStatus::Ok);
  rig.run(0.007);
  EXPECT_EQ(rig.simulation.loads().motor_force, mechanism::Vector4(mechanism::Vector4::Zero()));
  rig.run(0.001);
  EXPECT_NEAR(rig.simulation.loads().motor_force[0], 50.0, 0.07);   // half a DAC step of 0.139 N
  EXPECT_NEAR(rig.simulation.loads().motor_force[3], 200.0, 0.61);  // half a DAC step of 1.2 N
  ASSERT_EQ(rig.bus->writeOutputs(0), hardware::IoStatus::Ok);
  rig.run(0.009);
  EXPECT_EQ(rig.simulation.loads().motor_force, mechanism::Vector4(mechanism::Vector4::Zero()));
}

TEST(RobotSimulation, StandsOnItsMotorsWhenTheBrakesAreReleasedAndFallsIntoThemWhenTheyAreNot) {
  Rig rig(parametersWith("brake"));
  const mechanism::Pose start = rig.simulation.state().pose;
  rig.push(rig.holding());
  ASSERT_EQ(rig.bus->writeOutputs(kDrives), hardware::IoStatus::Ok);
  rig.run(0.02);
  ASSERT_EQ(rig.bus->writeOutputs(kDrives | kRelease), hardware::IoStatus::Ok);
  rig.run(1.0);
  EXPECT_EQ(rig.image.status.brakes_engaged.load(), 0);
  EXPECT_EQ(rig.simulation.state().pose, start);                // the DAC's rounding is less than the Coulomb friction
  ASSERT_EQ(rig.bus->writeOutputs(0), hardware::IoStatus::Ok);  // as a guardian does
  rig.run(0.5);
  const double drop = start[1] - rig.simulation.state().pose[1];
  std::printf("drop from drives off until the brakes hold: %.2f mm\n", 1000 * drop);
  EXPECT_EQ(rig.simulation.state().pose_velocity, mechanism::Vector4(mechanism::Vector4::Zero()));
  EXPECT_GT(drop, 1e-4);
  EXPECT_LT(drop, 0.01);
}

TEST(RobotSimulation, LosesPowerAtOnceByTheEmergencyStopAndShowsItOnItsInput) {
  Rig rig(parametersWith("brake"));
  rig.push(rig.holding());
  ASSERT_EQ(rig.bus->writeOutputs(kDrives | kRelease), hardware::IoStatus::Ok);
  rig.run(0.1);
  EXPECT_EQ(rig.read().digital_inputs & 1, 1);
  rig.image.surroundings.emergency_stop_pressed.store(1);
  rig.run(kStep_s);
  EXPECT_EQ(rig.read().digital_inputs & 1, 0);
  EXPECT_EQ(rig.simulation.loads().motor_force, mechanism::Vector4(mechanism::Vector4::Zero()));
  rig.run(0.1);
  EXPECT_EQ(rig.image.status.brakes_engaged.load(), 0x0F);
  EXPECT_EQ(rig.simulation.state().pose_velocity, mechanism::Vector4(mechanism::Vector4::Zero()));
}

TEST(RobotSimulation, CountsTheLengthsWithinHalfACountWithTheSignOfEachEncoder) {
  mechanism::Robot robot = configuredRobot("A");
  robot.actuators[1].encoder_sign = -1;
  robot.actuators[2].force_sign = -1;
  Rig rig(parametersWith("none"), robot);
  const mechanism::Lengths start = rig.simulation.lengths();
  ASSERT_EQ(rig.bus->writeOutputs(kDrives | kRelease), hardware::IoStatus::Ok);
  for (int i = 0; i < 300; ++i) {
    rig.push(rig.holding() + mechanism::Vector4(40, -30, 50, 150));
    rig.run(kStep_s);
    const hardware::AxisFeedback feedback = rig.read();
    for (int axis = 0; axis < 4; ++axis) {
      const mechanism::Actuator& actuator = rig.robot.actuators[static_cast<std::size_t>(axis)];
      const double counted =
          actuator.encoder_sign * feedback.counts[static_cast<std::size_t>(axis)] * actuator.metresPerCount();
      const double moved = rig.simulation.lengths()[axis] - start[axis];
      ASSERT_NEAR(counted, moved, 1.001 * actuator.metresPerCount());  // two roundings: now, and at the reset
    }
  }
  EXPECT_GT((rig.simulation.lengths() - start).cwiseAbs().maxCoeff(), 0.002);
}

TEST(RobotSimulation, IsTheSameToTheLastBitEveryTime) {
  const auto play = [] {
    Rig rig(parametersWith("brake"));
    EXPECT_EQ(rig.bus->writeOutputs(kDrives | kRelease), hardware::IoStatus::Ok);
    for (int i = 0; i < 500; ++i) {
      const double t = 1e-3 * i;
      rig.push(rig.holding() +
               80.0 * mechanism::Vector4(std::sin(9 * t), std::sin(7 * t), std::sin(8 * t), std::sin(5 * t)));
      rig.run(kStep_s);
    }
    return rig.simulation.state();
  };
  const PlantState first = play();
  const PlantState second = play();
  EXPECT_EQ(first.pose, second.pose);
  EXPECT_EQ(first.pose_velocity, second.pose_velocity);
}

TEST(RobotSimulation, CarriesAPayloadWithItsWholeWeight) {
  Rig empty(parametersWith("brake"));
  Rig loaded(parametersWith("brake", "payload: {mass_kg: 15, center_m: [0, 0, 0], radius_of_gyration_m: 0.1}\n"));
  const mechanism::Pose pose = empty.simulation.state().pose;
  mechanism::Motion motion;
  motion.pose = pose;
  mechanism::RobotMotion moved;
  mechanism::robotMotion(empty.simulation.model().rigid.mechanism, motion, moved);
  const mechanism::Vector4 difference = dynamics::poseForces(loaded.simulation.model().rigid, moved) -
                                        dynamics::poseForces(empty.simulation.model().rigid, moved);
  EXPECT_NEAR(difference[1], 15.0 * 9.81, 1e-9);
  EXPECT_NEAR(difference[0], 0.0, 1e-9);
}

TEST(RobotSimulation, RefusesWhatCannotBe) {
  SimulationParameters beyond = parametersWith("brake");
  beyond.start_lengths_m = mechanism::Vector4(0.6576, 0.6990, 1.2, 0.6671);
  EXPECT_NE(refusalOf([&] { Rig rig(beyond); }).find("leg 3 at 1.2 m is beyond its stops, 0.495 to 1.005 m"),
            std::string::npos);
  SimulationParameters impossible = parametersWith("brake");
  impossible.start_lengths_m = mechanism::Vector4(0.5, 1.0, 0.5, 1.0);
  EXPECT_NE(refusalOf([&] { Rig rig(impossible); }).find("cannot have these lengths together"), std::string::npos);
  EXPECT_NE(refusalOf([] { parseSimulationParameters("axes: []\n", "test.yaml"); }).find("has 0 entries"),
            std::string::npos);
}

}  // namespace
}  // namespace knee_robot::simulation
