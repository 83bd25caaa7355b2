#include "knee_robot/control/driver.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fake_machine.h"

namespace knee_robot::control {
namespace {

using fake::kHome;

struct DriverFeed : rt::TaskContext {
  DriverFeed() : rt::TaskContext("DriverFeed") {}
  rt::OutputPort<SupervisorCommand> orders{*this, "orders", ""};
  rt::OutputPort<AxesMeasurement> measurement{*this, "measurement", ""};
  rt::OutputPort<SetPoint> set_point{*this, "set_point", ""};
  rt::OutputPort<FeedforwardForce> load{*this, "load", ""};
  rt::InputPort<AxisCommand> command{*this, "command", ""};
};

/// One Driver, fed by hand once a millisecond; set points idle unless told otherwise.
class DriverTest : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override { make(1); }
  void make(int axis) {
    driver.axis.set(axis);
    rt::connect(feed.orders, driver.orders);
    rt::connect(feed.measurement, driver.measurement);
    rt::connect(feed.set_point, driver.set_point);
    rt::connect(feed.load, driver.feedforward);
    rt::connect(driver.command, feed.command);
    ASSERT_TRUE(driver.configure());
    ASSERT_TRUE(driver.start());
    measured.status = hardware::IoStatus::Ok;
    measured.position_m.fill(fake::kHome);
    set_point.duration = 10'000'000;
  }
  void cycle(int count = 1) {
    for (int k = 0; k < count; ++k) {
      now += 1'000'000;
      ++measured.sequence;
      measured.time = now;
      if (measurements_come) feed.measurement.write(measured);
      if (now % set_point.duration == 0 && set_points_come) {
        ++set_point.sequence;
        set_point.start = now;
        feed.set_point.write(set_point);
      }
      feed.orders.write(orders);
      if (feedforward_active) {
        ++model_force.sequence;
        model_force.time = now;
        feed.load.write(model_force);
      }
      rt::Cycle c;
      c.time = c.wake = now;
      c.period = 1'000'000;
      driver.update(c);
      feed.command.read(command);
    }
  }
  void takeOver() {
    orders.drivers_active = true;
    cycle();
    ASSERT_TRUE(command.active);
  }

  Driver driver{"Driver1", fake::robot()};
  DriverFeed feed;
  SupervisorCommand orders;
  AxesMeasurement measured;
  SetPoint set_point;
  AxisCommand command;
  FeedforwardForce model_force;
  bool feedforward_active = false;
  bool measurements_come = true, set_points_come = true;
  rt::Nanoseconds now = 0;
};

TEST_F(DriverTest, AsksForNothingUntilItIsToldToTakeOver) {
  cycle(20);
  EXPECT_FALSE(command.active);
  EXPECT_EQ(command.volts, 0.0);
}

TEST_F(DriverTest, TakesOverAtTheMeasuredPositionWithoutAStepOfForce) {
  measured.position_m[0] = 0.7123;
  takeOver();
  EXPECT_EQ(command.volts, 0.0);
  EXPECT_EQ(command.reference_m, 0.7123);
}

TEST_F(DriverTest, ForgetsItsIntegralWhenItIsSwitchedOff) {
  takeOver();
  measured.position_m[0] -= 0.001;
  cycle(300);
  EXPECT_GT(command.volts, 1.0);
  orders.drivers_active = false;
  cycle();
  EXPECT_EQ(command.volts, 0.0);
  takeOver();
  EXPECT_EQ(command.volts, 0.0) << "never resume with an old integral or reference";
  EXPECT_EQ(command.reference_m, measured.position_m[0]);
}

TEST_F(DriverTest, PushesAgainstADisplacementWithNewtonsConvertedToVolts) {
  takeOver();
  measured.position_m[0] -= 0.0001;
  cycle();
  EXPECT_GT(command.force_N, 0.0);
  EXPECT_NEAR(command.force_N, 28.4628 * command.volts, 1e-9);
}

TEST_F(DriverTest, StaysWithinTheVoltageLimit) {
  takeOver();
  measured.position_m[0] -= 0.0079;  // just within the following-error limit
  cycle(100);
  EXPECT_NEAR(command.volts, 9.5, 1e-9);
}

TEST_F(DriverTest, AddsTheFeedforward) {
  feedforward_active = true;
  model_force.force_N[0] = 56.9256;
  takeOver();
  EXPECT_NEAR(command.volts, 2.0, 1e-9);
  EXPECT_NEAR(command.feedforward_N, 56.9256, 1e-9);
}

TEST_F(DriverTest, TakesUpWhatTheFeedforwardSwitchesWithoutAJump) {
  feedforward_active = true;
  model_force.force_N[0] = 50.0;
  model_force.complete = true;
  takeOver();
  EXPECT_TRUE(command.loaded);
  model_force.force_N[0] = 20.0;  // switched
  model_force.switched_N[0] = -30.0;
  cycle();
  EXPECT_NEAR(command.force_N, 50.0, 1e-9);
  model_force.force_N[0] = 35.0;  // the load has changed
  cycle();
  EXPECT_NEAR(command.force_N, 65.0, 1e-9);
  feedforward_active = false;  // silent
  cycle(20);
  EXPECT_NEAR(command.force_N, 65.0, 1e-9);
  EXPECT_EQ(command.feedforward_N, 0.0);
  feedforward_active = true;
  cycle();
  EXPECT_NEAR(command.force_N, 65.0, 1e-9);
  EXPECT_EQ(command.feedforward_N, 35.0);
  model_force.complete = false;
  cycle();
  EXPECT_FALSE(command.loaded) << "the Supervisor keeps the holding brakes engaged";
}

TEST_F(DriverTest, LetsTheModelsFeedbackTakeThePlaceOfItsOwnAndBackWithoutAJump) {
  feedforward_active = true;
  takeOver();
  measured.position_m[0] -= 0.0004;
  cycle(100);
  const double alone = command.force_N;
  ASSERT_GT(alone, 20.0);
  model_force.loop_N[0] = 5.0;
  model_force.closes_loop = true;
  cycle();
  EXPECT_NEAR(command.force_N, alone, 1.0) << "the integral takes up what P and D gave";
  model_force.loop_N[0] = 25.0;
  cycle();
  EXPECT_NEAR(command.force_N, alone + 20.0, 1.0) << "the model's feedback counts in full";
  feedforward_active = false;  // it falls silent
  cycle(10);
  EXPECT_NEAR(command.force_N, alone + 20.0, 3.0) << "its own P and D are back";
  measured.position_m[0] -= 0.0001;
  cycle();
  EXPECT_GT(command.force_N, alone + 23.0);
}

TEST_F(DriverTest, WindsNothingUpWhileTheModelsFeedbackIsBeyondTheForceLimit) {
  feedforward_active = true;
  takeOver();
  cycle(10);
  model_force.loop_N[0] = 2000.0;
  measured.position_m[0] -= 0.0005;  // the integral would grow the same way
  cycle(400);
  EXPECT_NEAR(command.force_N, 28.4628 * 9.5, 0.01) << "the clamp";
  measured.position_m[0] += 0.0005;
  model_force.loop_N[0] = 0.0;
  cycle(20);
  EXPECT_LT(std::abs(command.force_N), 1.0) << "nothing is left of it";
}

TEST_F(DriverTest, GivesUpTheLoopOnAFollowingErrorAndKeepsTheFault) {
  takeOver();
  measured.position_m[0] -= 0.009;
  cycle();
  EXPECT_EQ(command.fault, Fault::FollowingError);
  EXPECT_FALSE(command.active);
  measured.position_m[0] = fake::kHome;
  cycle(10);
  EXPECT_EQ(command.fault, Fault::FollowingError) << "latched";
  orders.drivers_active = false;
  cycle();
  EXPECT_EQ(command.fault, Fault::None);
}

TEST_F(DriverTest, RefusesWhatIsNoNumberWhereverItComesFrom) {
  takeOver();
  measured.position_m[0] = std::nan("");
  cycle();
  EXPECT_EQ(command.fault, Fault::NotANumber);
  EXPECT_TRUE(std::isfinite(command.volts));
  EXPECT_FALSE(command.active);
}

TEST_F(DriverTest, RefusesAFeedforwardThatIsNoNumber) {
  takeOver();
  feedforward_active = true;
  model_force.force_N[0] = std::nan("");
  cycle();
  EXPECT_EQ(command.fault, Fault::NotANumber);
  EXPECT_TRUE(std::isfinite(command.volts));
}

TEST_F(DriverTest, HoldsUnderControlWhenSetPointsStopComing) {
  takeOver();
  cycle(20);
  set_points_come = false;
  cycle(35);
  EXPECT_EQ(command.fault, Fault::SetPointStale);
  EXPECT_TRUE(command.active) << "the loop goes on";
  EXPECT_EQ(command.reference_m, fake::kHome);
}

TEST_F(DriverTest, GivesUpAfterThreeUnreadableCyclesButNotAfterOne) {
  takeOver();
  measurements_come = false;
  cycle(2);
  EXPECT_TRUE(command.active);
  measurements_come = true;
  cycle();
  EXPECT_TRUE(command.active);
  measured.status = hardware::IoStatus::Disconnected;
  cycle(3);
  EXPECT_EQ(command.fault, Fault::MeasurementLost);
  EXPECT_FALSE(command.active);
}

TEST_F(DriverTest, RefusesASetPointThatIsNoNumber) {
  takeOver();
  set_point.phase = SyncPhase::Playing;
  set_point.run = 1;
  set_point.from_m.fill(fake::kHome);
  set_point.to_m.fill(std::nan(""));
  cycle(10);
  EXPECT_EQ(command.fault, Fault::NotANumber);
  EXPECT_TRUE(std::isfinite(command.reference_m));
}

/// Closed loop on masses from the motor's rotor alone to a heavy platform's share, with either motor: one set of gains.
class OneSetOfGains : public ::testing::TestWithParam<std::tuple<int, double>> {};

TEST_P(OneSetOfGains, HoldsEveryMassUnderGravityWithoutOscillating) {
  const auto [axis, mass] = GetParam();
  const mechanism::Robot robot = fake::robot();
  const mechanism::Actuator& actuator = robot.actuators[static_cast<std::size_t>(axis) - 1];
  Driver driver("Driver", robot);
  driver.axis.set(axis);
  DriverFeed feed;
  rt::connect(feed.orders, driver.orders);
  rt::connect(feed.measurement, driver.measurement);
  rt::connect(feed.set_point, driver.set_point);
  rt::connect(driver.command, feed.command);
  ASSERT_TRUE(driver.configure() && driver.start());
  double position = fake::kHome, velocity = 0.0, lowest = fake::kHome, late_speed = 0.0;
  for (int ms = 0; ms < 3000; ++ms) {
    AxesMeasurement measured;
    measured.sequence = static_cast<std::uint64_t>(ms) + 1;
    measured.status = hardware::IoStatus::Ok;
    const double step = actuator.metresPerCount();
    measured.position_m[static_cast<std::size_t>(axis) - 1] =
        fake::kHome + step * std::round((position - fake::kHome) / step);
    feed.measurement.write(measured);
    SupervisorCommand orders;
    orders.drivers_active = true;
    feed.orders.write(orders);
    rt::Cycle cycle;
    cycle.time = rt::Nanoseconds{1'000'000} * ms;
    cycle.period = 1'000'000;
    if (ms % 10 == 0) {
      SetPoint idle;
      idle.sequence = static_cast<std::uint64_t>(ms);
      idle.start = cycle.time;
      idle.duration = 10'000'000;
      feed.set_point.write(idle);
    }
    driver.update(cycle);
    AxisCommand command;
    feed.command.read(command);
    ASSERT_EQ(command.fault, Fault::None) << ms;
    for (int k = 0; k < 10; ++k) {
      const double force = actuator.force_sign * actuator.force_per_volt_N * command.volts - 60.0 - 50.0 * velocity;
      velocity += 1e-4 * force / mass;
      position += 1e-4 * velocity;
    }
    lowest = std::min(lowest, position);
    if (ms > 2500) late_speed = std::max(late_speed, std::abs(velocity));
  }
  EXPECT_NEAR(position, fake::kHome, 5e-5);
  EXPECT_GT(lowest, fake::kHome - 0.004) << "60 N appear at once, as if the brake had opened";
  EXPECT_LT(late_speed, 0.01);
  std::printf("axis %d, %4.1f kg: sinks %.2f mm, at rest below %.2f mm/s\n", axis, mass, 1e3 * (fake::kHome - lowest),
              1e3 * late_speed);
}

INSTANTIATE_TEST_SUITE_P(Fit, OneSetOfGains,
                         ::testing::Combine(::testing::Values(1, 3, 4), ::testing::Values(3.0, 10.0, 30.0)));

}  // namespace
}  // namespace knee_robot::control
