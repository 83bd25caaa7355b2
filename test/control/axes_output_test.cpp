#include "src/control/axes_output.h"

#include <gtest/gtest.h>

#include <limits>

#include "fake_machine.h"

namespace knee_robot::control {
namespace {

struct AxesOutputFeed : rt::TaskContext {
  AxesOutputFeed() : rt::TaskContext("AxesOutputFeed") {}
  rt::OutputPort<SupervisorCommand> orders{*this, "orders", ""};
  rt::OutputPort<AxesMeasurement> measurement{*this, "measurement", ""};
  rt::OutputPort<AxisCommand> command_1{*this, "command_1", ""};
  rt::OutputPort<AxisCommand> command_2{*this, "command_2", ""};
  rt::OutputPort<AxisCommand> command_3{*this, "command_3", ""};
  rt::OutputPort<AxisCommand> command_4{*this, "command_4", ""};
  rt::InputPort<AxesWritten> written{*this, "written", ""};
};

/// AxesOutput alone, fed by hand once a millisecond.
class AxesOutputTest : public ::testing::Test {
 protected:
  void SetUp() override {
    rt::connect(feed.orders, output.orders);
    rt::connect(feed.measurement, output.measurement);
    rt::connect(feed.command_1, output.command_1);
    rt::connect(feed.command_2, output.command_2);
    rt::connect(feed.command_3, output.command_3);
    rt::connect(feed.command_4, output.command_4);
    rt::connect(output.written, feed.written);
    ASSERT_TRUE(output.configure());
    ASSERT_TRUE(output.start());
    for (std::size_t i = 0; i < hardware::kAxes; ++i) {
      commands[i].axis = static_cast<int>(i) + 1;
      commands[i].active = commands[i].at_rest = true;
      commands[i].volts = 0.5 + static_cast<double>(i);
    }
  }
  void cycle(int count = 1) {
    for (int k = 0; k < count; ++k) {
      now += 1'000'000;
      machine.time_s = rt::toSeconds(now);
      orders.time = now;
      if (orders_come) feed.orders.write(orders);
      rt::OutputPort<AxisCommand>* const ports[] = {&feed.command_1, &feed.command_2, &feed.command_3, &feed.command_4};
      for (std::size_t i = 0; i < hardware::kAxes; ++i) {
        commands[i].time = now;
        if (comes[i]) ports[i]->write(commands[i]);
      }
      rt::Cycle c;
      c.time = c.wake = now;
      c.period = 1'000'000;
      output.update(c);
      feed.written.read(written);
    }
  }
  void release() {
    orders.level = DriveLevel::Released;
    orders.drivers_active = true;
    cycle(300);
    ASSERT_EQ(written.level, DriveLevel::Released);
  }

  fake::Machine machine{fake::robot()};
  AxesOutput output{"AxesOutput", fake::robot(), fake::hardware(), machine};
  AxesOutputFeed feed;
  SupervisorCommand orders;
  std::array<AxisCommand, hardware::kAxes> commands{};
  std::array<bool, hardware::kAxes> comes{true, true, true, true};
  bool orders_come = true;
  AxesWritten written;
  rt::Nanoseconds now = 0;
};

TEST_F(AxesOutputTest, ClimbsOneLevelACycleAndWritesZeroBelowTheLoops) {
  orders.level = DriveLevel::Released;
  cycle();
  EXPECT_EQ(written.level, DriveLevel::Energised);
  EXPECT_EQ(machine.volts, AxisValues{});
  EXPECT_FALSE(machine.released());
  cycle();
  EXPECT_EQ(written.level, DriveLevel::HeldByDrivers);
  EXPECT_NE(machine.volts, AxisValues{});
  EXPECT_FALSE(machine.released());
  cycle();
  EXPECT_TRUE(machine.released());
}

TEST_F(AxesOutputTest, NeverReleasesWithoutFourClosedLoops) {
  commands[2].active = false;
  orders.level = DriveLevel::Released;
  cycle(50);
  EXPECT_EQ(written.level, DriveLevel::Energised);
  EXPECT_FALSE(machine.released());
}

TEST_F(AxesOutputTest, TogglesTheHeartbeatEveryCycle) {
  cycle();
  for (int k = 0; k < 5; ++k) {
    const unsigned before = machine.bits & 4u;
    cycle();
    EXPECT_NE(machine.bits & 4u, before);
  }
}

TEST_F(AxesOutputTest, ClampsVoltsAndForceWhateverTheDriversAskFor) {
  release();
  commands[0].volts = 1e9;
  commands[1].volts = -1e9;
  commands[3].volts = 9.0;
  cycle();
  EXPECT_NEAR(machine.volts[0], 9.5, 0.003);
  EXPECT_NEAR(machine.volts[1], -9.5, 0.003);
  EXPECT_LE(machine.volts[3] * 246.6779, 1000.0 + 0.7) << "force_max_N";
  EXPECT_EQ(written.safe_stop, SafeStopPhase::Idle);
}

TEST_F(AxesOutputTest, PutsTheLoadEstimateInPlaceOfWhatIsNoNumber) {
  release();
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    commands[1].volts = bad;
    cycle();
    EXPECT_EQ(written.fault, Fault::NotANumber);
    EXPECT_EQ(written.fault_axis, 2);
    EXPECT_NEAR(machine.volts[1], 1.5, 0.4) << "about what it was, not 0 V and not the limit";
    EXPECT_NEAR(machine.volts[0], 0.5, 0.01) << "the others keep their loops";
  }
  cycle(200);
  EXPECT_EQ(written.level, DriveLevel::Off);
  EXPECT_EQ(machine.volts, AxisValues{});
  EXPECT_EQ(written.safe_stops, 1u);
}

TEST_F(AxesOutputTest, BeginsTheSafeStopWithinThreeCyclesOfTheLastCommandOrOrder) {
  release();
  comes[3] = false;
  cycle(3);
  EXPECT_NE(written.safe_stop, SafeStopPhase::Idle);
  EXPECT_EQ(written.fault, Fault::CommandStale);
  EXPECT_EQ(written.fault_axis, 4);
}

TEST_F(AxesOutputTest, TakesStaleOrdersForADeadSupervisor) {
  release();
  orders_come = false;
  cycle(3);
  EXPECT_EQ(written.fault, Fault::OrdersStale);
  cycle(300);
  EXPECT_EQ(written.level, DriveLevel::Off);
  EXPECT_EQ(machine.bits & 3u, 0u);
}

TEST_F(AxesOutputTest, RefusesACommandOnTheWrongWire) {
  std::swap(commands[0].axis, commands[1].axis);
  orders.level = DriveLevel::Released;
  cycle(50);
  EXPECT_EQ(written.level, DriveLevel::Energised);
}

TEST_F(AxesOutputTest, GoesDownOnlyThroughTheSafeStopAndUpAgainOnlyAfterItWasOff) {
  release();
  orders.level = DriveLevel::Energised;
  cycle();
  EXPECT_EQ(written.safe_stop, SafeStopPhase::Settling) << "the references stand still";
  cycle(500);
  EXPECT_EQ(written.safe_stop, SafeStopPhase::Done);
  EXPECT_EQ(written.level, DriveLevel::Off) << "still ordered on, but it was never ordered off";
  orders.level = DriveLevel::Off;
  cycle();
  orders.level = DriveLevel::Energised;
  cycle();
  EXPECT_EQ(written.level, DriveLevel::Energised);
}

}  // namespace
}  // namespace knee_robot::control
