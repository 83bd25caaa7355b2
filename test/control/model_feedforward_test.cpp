// The feedforward by itself, and what it does to the take-over: no jump, no number that is none, no force that was not
// asked for.
#include "knee_robot/control/model_feedforward.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/inverse_dynamics.h"
#include "some_model.h"
#include "test/allocation_guard.h"
#include "test/refusal.h"

namespace knee_robot::control {
namespace {

const std::string kFinal = std::string(KNEE_SOURCE_DIR) + "/config/robots/final.yaml";

struct FeedforwardFeed : rt::TaskContext {
  FeedforwardFeed() : rt::TaskContext("FeedforwardFeed") {}
  rt::OutputPort<SupervisorCommand> orders{*this, "orders", ""};
  rt::OutputPort<AxesMeasurement> measurement{*this, "measurement", ""};
  rt::OutputPort<AxisCommand> command_1{*this, "command_1", ""}, command_2{*this, "command_2", ""},
      command_3{*this, "command_3", ""}, command_4{*this, "command_4", ""};
  rt::InputPort<FeedforwardForce> force{*this, "force", ""};
};

std::string temporaryFile(const char* name) {
  return ::testing::TempDir() + std::to_string(::getpid()) + "_" + name;
}

class ModelFeedforwardTest : public ::testing::Test {
 protected:
  void begin() {
    rt::connect(feed.orders, component.orders);
    rt::connect(feed.measurement, component.measurement);
    rt::connect(feed.command_1, component.command_1);
    rt::connect(feed.command_2, component.command_2);
    rt::connect(feed.command_3, component.command_3);
    rt::connect(feed.command_4, component.command_4);
    rt::connect(component.feedforward, feed.force);
    ASSERT_TRUE(component.configure()) << component.refusal();
    ASSERT_TRUE(component.start());
    measured.status = hardware::IoStatus::Ok;
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      measured.position_m[i] = robot.actuators[i].home_length_m;
    orders.homed = true;
  }
  void cycle(int count = 1) {
    for (int k = 0; k < count; ++k) {
      now += 1'000'000;
      ++measured.sequence;
      feed.measurement.write(measured);
      feed.orders.write(orders);
      rt::OutputPort<AxisCommand>* const ports[] = {&feed.command_1, &feed.command_2, &feed.command_3, &feed.command_4};
      for (auto* port : ports) {
        AxisCommand command;
        command.active = orders.drivers_active;
        command.time = now - 1'000'000;
        command.reference_velocity = reference_velocity;
        port->write(command);
      }
      rt::Cycle c;
      c.time = c.wake = now;
      c.period = 1'000'000;
      component.update(c);
      feed.force.read(force);
    }
  }
  void carry() {
    orders.drivers_active = true;
    cycle(40);
    ASSERT_TRUE(force.complete);
  }
  mechanism::Vector4 weightAtHome() const {
    mechanism::Motion motion;
    motion.pose =
        mechanism::forwardKinematicsFromHome(*robot.mechanism, mechanism::Lengths(measured.position_m.data())).pose;
    mechanism::Vector4 forces = mechanism::Vector4::Zero();
    EXPECT_TRUE(dynamics::inverseDynamics(
        dynamics::RigidModel(*robot.mechanism, robot.gravity, dynamics::loadRobotInertia(robot)), motion, forces));
    return forces;
  }
  /// What motors get beside the loops: the part of the force that the integrals did not have to make up for.
  AxisValues felt() const {
    AxisValues values{};
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      values[i] = force.force_N[i] - force.switched_N[i];
    return values;
  }

  mechanism::Robot robot = mechanism::loadRobot(kFinal);
  ModelFeedforward component{"Feedforward", robot};
  FeedforwardFeed feed;
  SupervisorCommand orders;
  AxesMeasurement measured;
  double reference_velocity = 0.0;
  FeedforwardForce force;
  rt::Nanoseconds now = 0;
};

TEST_F(ModelFeedforwardTest, IsTheWeightOfTheUrdfAtTheMeasuredPose) {
  begin();
  cycle(10);
  EXPECT_EQ(force.force_N, AxisValues{}) << "the Drivers do not carry yet";
  EXPECT_FALSE(force.complete);
  carry();
  const mechanism::Vector4 weight = weightAtHome();
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    EXPECT_NEAR(force.force_N[i], weight[static_cast<Eigen::Index>(i)], 1e-6);
    EXPECT_EQ(force.switched_N[i], 0.0);
  }
  EXPECT_GT(force.force_N[3], 50.0);
  orders.drivers_active = false;
  cycle();
  EXPECT_EQ(force.force_N, AxisValues{});
}

TEST_F(ModelFeedforwardTest, RisesWithoutAStepAndIsCompleteOnlyWhenAllIsThere) {
  begin();
  orders.drivers_active = true;
  double last = 0.0;
  const double whole = weightAtHome()[3];
  for (int k = 0; k < 60; ++k) {
    cycle();
    EXPECT_LE(std::abs(force.force_N[3] - last), whole / 29.0);
    EXPECT_TRUE(!force.complete || std::abs(force.force_N[3] - whole) < 1e-6);
    last = force.force_N[3];
  }
  EXPECT_TRUE(force.complete);
}

TEST_F(ModelFeedforwardTest, HandsWhatIsSwitchedToTheIntegralsSoThatTheMotorsFeelNothing) {
  begin();
  carry();
  const AxisValues before = felt();
  component.share_gravity.set(0.2);
  component.payload.set(15.0);
  AxisValues last = force.force_N;
  for (int k = 0; k < 800; ++k) {
    cycle();
    for (std::size_t i = 0; i < hardware::kAxes; ++i) {
      EXPECT_NEAR(felt()[i], before[i], 1e-9);
      EXPECT_LT(std::abs(force.force_N[i] - last[i]), 2.0) << "not at once either";
    }
    last = force.force_N;
  }
  EXPECT_GT(std::abs(force.force_N[3] - before[3]), 1.0) << "it was switched";
}

TEST_F(ModelFeedforwardTest, CarriesADeclaredPayloadAsAMassAtThePlatformsOrigin) {
  component.payload.set(15.0);
  begin();
  carry();
  dynamics::RobotInertia inertia = dynamics::loadRobotInertia(robot);
  dynamics::LinkParameters platform = dynamics::toParameters(inertia.links[dynamics::kPlatformLink]);
  platform[9] += 15.0;
  inertia.links[dynamics::kPlatformLink] = dynamics::fromParameters(platform);
  mechanism::Motion motion;
  motion.pose =
      mechanism::forwardKinematicsFromHome(*robot.mechanism, mechanism::Lengths(measured.position_m.data())).pose;
  mechanism::Vector4 forces = mechanism::Vector4::Zero();
  ASSERT_TRUE(
      dynamics::inverseDynamics(dynamics::RigidModel(*robot.mechanism, robot.gravity, inertia), motion, forces));
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const double limit = 0.8 * 300.0;
    EXPECT_NEAR(force.force_N[i], std::clamp(forces[static_cast<Eigen::Index>(i)], -limit, limit), 1e-6);
  }
}

TEST_F(ModelFeedforwardTest, NeverExceedsItsShareOfTheForceLimit) {
  component.payload.set(50.0);
  component.largest_share.set(0.5);
  begin();
  carry();
  double largest = 0.0;
  for (const double one : force.force_N)
    largest = std::max(largest, std::abs(one));
  EXPECT_EQ(largest, 150.0);
}

TEST_F(ModelFeedforwardTest, GivesNothingWithoutAPoseAndLeavesItToTheIntegrals) {
  begin();
  carry();
  const AxisValues before = felt();
  const AxisValues good = measured.position_m;
  for (const double bad : {std::nan(""), 2.5, -1.0}) {
    measured.position_m[1] = bad;
    cycle();
    EXPECT_EQ(force.force_N, AxisValues{}) << bad;
    EXPECT_TRUE(force.complete) << "the holding brakes are not kept waiting for ever";
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      EXPECT_NEAR(felt()[i], before[i], 1e-9);
    measured.position_m = good;
    cycle(100);
    EXPECT_GT(force.force_N[3], 1.0);
    EXPECT_LT(force.force_N[3], 0.3 * weightAtHome()[3]) << "back slowly";
    cycle(600);
    EXPECT_NEAR(force.force_N[3], weightAtHome()[3], 1e-6);
  }
  measured.status = hardware::IoStatus::Disconnected;
  cycle(3);
  EXPECT_NEAR(force.force_N[3], weightAtHome()[3], 1e-6) << "unreadable encoders: the last pose";
}

TEST_F(ModelFeedforwardTest, GivesNothingWhileHomingNorWhenNotHomed) {
  begin();
  orders.homed = false;
  orders.drivers_active = true;
  cycle(50);
  EXPECT_EQ(force.force_N, AxisValues{});
  orders.drivers_active = false;
  orders.homed = true;
  cycle();
  carry();
  orders.homing = 2;
  cycle();
  orders.homing = 0;
  cycle(50);
  EXPECT_EQ(force.force_N, AxisValues{}) << "until the Drivers are switched off";
}

TEST_F(ModelFeedforwardTest, AddsFrictionAlongTheReferenceAndLetsGoOfItAtRest) {
  const std::string path = temporaryFile("model_feedforward_test.yaml");
  dynamics::saveModel(fake::modelOf(robot), path);
  component.model.set(path);
  component.share_friction.set(1.0);
  component.share_inertia.set(0.0);
  begin();
  std::remove(path.c_str());
  carry();
  const AxisValues rest = force.force_N;
  const mechanism::Vector4 weight = weightAtHome();
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    EXPECT_NEAR(rest[i], weight[static_cast<Eigen::Index>(i)], 1e-6);
  for (const double velocity : {0.01, -0.01}) {
    reference_velocity = velocity;
    cycle(25);  // its friction builds up over 0.1 mm, and has to turn
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      EXPECT_NEAR(force.force_N[i] - rest[i], std::copysign(15.0, velocity) + 150.0 * velocity, 1e-6);
  }
  reference_velocity = 0.0;
  cycle(1);
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    EXPECT_NEAR(force.force_N[i] - rest[i], -15.0, 0.1) << "held where the reference turns";
  cycle(6000);
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    EXPECT_NEAR(force.force_N[i], rest[i], 1e-6);
  EXPECT_EQ(force.switched_N, AxisValues{}) << "friction is a load, nothing that is switched";
}

TEST_F(ModelFeedforwardTest, AddsTracedEffectsAndNamesThoseThatItLeavesOut) {
  const std::string path = temporaryFile("model_feedforward_traced_test.yaml");
  dynamics::ModelEffect offset = fake::stribeckOf(1), play = fake::stribeckOf(3);
  offset.name = "force_offset";
  offset.shape.clear();
  play.name = "backlash";
  dynamics::Model model = fake::tracedModelOf(robot, {fake::stribeckOf(2), offset, play});
  dynamics::saveModel(model, path);
  component.model.set(path);
  component.share_friction.set(1.0);
  component.share_inertia.set(0.0);
  begin();
  std::remove(path.c_str());
  EXPECT_NE(component.source().find("without backlash of axis 3 (it moves"), std::string::npos) << component.source();
  carry();
  const mechanism::Vector4 weight = weightAtHome();
  EXPECT_NEAR(force.force_N[0], weight[0] + 10.0, 1e-6) << "an offset is there at rest";
  EXPECT_NEAR(force.force_N[1], weight[1], 1e-6);
  reference_velocity = 0.01;
  cycle(25);
  EXPECT_NEAR(force.force_N[1] - weight[1], 15.0 + 1.5 + 10.0 * std::exp(-1.0), 1e-6);
  EXPECT_NEAR(force.force_N[2] - weight[2], 15.0 + 1.5, 1e-6);
}

TEST_F(ModelFeedforwardTest, LetsNoReferenceThatIsNoNumberThrough) {
  const std::string path = temporaryFile("model_feedforward_nan_test.yaml");
  dynamics::saveModel(fake::modelOf(robot), path);
  component.model.set(path);
  begin();
  std::remove(path.c_str());
  carry();
  reference_velocity = std::nan("");
  cycle(3);
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    EXPECT_TRUE(std::isfinite(force.force_N[i]));
    EXPECT_TRUE(std::isfinite(force.switched_N[i]));
  }
}

TEST_F(ModelFeedforwardTest, FeedsTheErrorBackThroughTheModelWithoutAllocatingAndLetsGoOfItWhereThePoseIsLost) {
  const std::string path = temporaryFile("model_feedforward_law_test.yaml");
  dynamics::saveModel(fake::modelOf(robot), path);
  component.model.set(path);
  component.law.set("computed_torque");
  ASSERT_NO_FATAL_FAILURE(begin());
  std::remove(path.c_str());
  ASSERT_NO_FATAL_FAILURE(carry());
  EXPECT_TRUE(force.closes_loop);
  allocations = 0;
  armed = true;
  reference_velocity = 0.01;
  cycle(20);
  armed = false;
  EXPECT_EQ(allocations, 0);
  EXPECT_NE(force.loop_N[0], 0.0);
  measured.position_m[0] = 0.01;  // no such pose
  cycle();
  EXPECT_FALSE(force.closes_loop) << "the Drivers close their own loops again";
  EXPECT_EQ(force.loop_N[0], 0.0);
}

TEST_F(ModelFeedforwardTest, RefusesModelsThatAreNotThisRobotsByFileAndReason) {
  const std::string path = temporaryFile("model_feedforward_refused_test.yaml");
  const auto refusal = [&](const dynamics::Model& model) {
    dynamics::saveModel(model, path);
    component.model.set(path);
    const std::string sentence = refusalOf([&] { component.loadModel(); });
    std::remove(path.c_str());
    EXPECT_NE(sentence.find(path), std::string::npos) << sentence;
    return sentence;
  };
  dynamics::Model other = fake::modelOf(robot);
  other.robot_fingerprint = "0";
  EXPECT_NE(refusal(other).find("another version of the robot file"), std::string::npos);
  dynamics::Model traced = fake::modelOf(robot);
  traced.effects = {fake::stribeckOf(2)};
  traced.effects.front().name = "stick";
  EXPECT_NE(refusal(traced).find("stick"), std::string::npos);
  component.model.set("/nowhere/model.yaml");
  EXPECT_THROW(component.loadModel(), InputError);
  EXPECT_FALSE(component.configure());
}

}  // namespace
}  // namespace knee_robot::control
