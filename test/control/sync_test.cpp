#include "src/control/sync.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fake_machine.h"

namespace knee_robot::control {
namespace {

using fake::kHome;

struct SyncFeed : rt::TaskContext {
  SyncFeed() : rt::TaskContext("SyncFeed") {}
  rt::OutputPort<SupervisorCommand> orders{*this, "orders", ""};
  rt::OutputPort<AxesMeasurement> measurement{*this, "measurement", ""};
  rt::InputPort<SetPoint> set_point{*this, "set_point", ""};
};

/// Sync alone, once in 10 ms; checks of every set point that it continues the last one.
class SyncTest : public ::testing::Test {
 protected:
  void SetUp() override {
    rt::connect(feed.orders, sync.orders);
    rt::connect(feed.measurement, sync.measurement);
    rt::connect(sync.set_point, feed.set_point);
    ASSERT_TRUE(sync.configure() && sync.start());
    orders.drivers_active = true;
    measured.status = hardware::IoStatus::Ok;
    measured.position_m.fill(fake::kHome);
    orders.level = DriveLevel::Released;
    for (int k = 0; k < 40; ++k)  // the Drivers have carried for long enough
      tick();
  }
  /// `distance` on all axes in `seconds`, from home.
  void load(double distance, double seconds) {
    const trajectory::Reference reference = fake::smoothReference(fake::kHome, distance, seconds);
    points.clear();
    for (Eigen::Index k = 0; k < reference.points.rows(); ++k) {
      AxisValues point{};
      for (std::size_t i = 0; i < hardware::kAxes; ++i)
        point[i] = reference.points(k, static_cast<Eigen::Index>(i));
      points.push_back(point);
    }
    sync.store().offer(ReferencePath::of(points));
  }
  void playAsTheBrakesOpen() {
    orders.level = DriveLevel::HeldByDrivers;
    tick();
    load(0.04, 2.0);
    ++orders.play;
    orders.level = DriveLevel::Released;
  }
  const SetPoint& tick() {
    orders.time = now;  // the Supervisor runs after Sync: its newest orders are those of the last executed cycle
    if (orders_come) feed.orders.write(orders);
    now += 10'000'000 + pause;
    pause = 0;
    feed.measurement.write(measured);
    rt::Cycle cycle;
    cycle.time = now;
    cycle.period = 10'000'000;
    sync.update(cycle);
    const SetPoint last = out;
    EXPECT_EQ(feed.set_point.read(out), rt::FlowStatus::NewData) << "one every period, idle or not";
    EXPECT_EQ(out.sequence, last.sequence + 1);
    if (out.run == last.run && last.phase != SyncPhase::Idle && out.phase != SyncPhase::Idle) {
      EXPECT_EQ(out.from_m, last.to_m);
      EXPECT_EQ(out.from_velocity, last.to_velocity);
    }
    return out;
  }

  Sync sync{"Sync", fake::robot()};
  SyncFeed feed;
  SupervisorCommand orders;
  AxesMeasurement measured;
  SetPoint out;
  std::vector<AxisValues> points;
  bool orders_come = true;
  rt::Nanoseconds now = 0;
  rt::Nanoseconds pause = 0;  // of the whole machine, before the next tick
};

TEST_F(SyncTest, StreamsEveryPointOnItsTickWithoutAGapAndHoldsTheLast) {
  load(0.02, 1.0);
  EXPECT_EQ(tick().phase, SyncPhase::Idle);
  ++orders.play;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    tick();
    ASSERT_EQ(out.phase, SyncPhase::Playing);
    for (std::size_t i = 0; i < hardware::kAxes; ++i) {
      EXPECT_NEAR(out.from_m[i], points[k][i], 1e-12) << k;
      EXPECT_NEAR(out.to_m[i], points[k + 1][i], 1e-12) << k;
    }
  }
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(tick().phase, SyncPhase::Holding);
    EXPECT_EQ(out.to_m, points.back());
    EXPECT_EQ(out.to_velocity, AxisValues{});
  }
}

TEST_F(SyncTest, RefusesWithAxisAndDistanceAwayFromTheFirstPoint) {
  ++orders.play;
  tick();
  EXPECT_EQ(out.refusal, PlayRefusal::NoReference);
  load(0.02, 1.0);
  measured.position_m[2] += 0.0031;
  ++orders.play;
  tick();
  EXPECT_EQ(out.phase, SyncPhase::Idle);
  EXPECT_EQ(out.refused_run, orders.play);
  EXPECT_EQ(out.refusal, PlayRefusal::NotAtStart);
  EXPECT_EQ(out.refused_axis, 3);
  EXPECT_NEAR(out.refused_distance_m, 0.0031, 1e-12);
  measured.position_m[2] = std::nan("");
  ++orders.play;
  EXPECT_EQ(tick().phase, SyncPhase::Idle) << "not a number is not near";
}

TEST_F(SyncTest, SlowsDownAlongThePathInTheGivenTime) {
  load(0.04, 2.0);
  ++orders.play;
  for (int k = 0; k < 100; ++k)
    tick();
  orders.stop_path = true;
  int ticks = 0;
  double last_scale = 1.0;
  while (tick().phase == SyncPhase::Stopping) {
    ++ticks;
    EXPECT_LE(out.time_scale, last_scale);
    EXPECT_GE(out.time_scale, last_scale - 0.0334);
    last_scale = out.time_scale;
    EXPECT_EQ(out.to_m[0], out.to_m[3]) << "on the path";
  }
  EXPECT_NEAR(ticks, 30, 1) << "0.3 s";
  EXPECT_EQ(out.phase, SyncPhase::Holding);
  const AxisValues held = out.to_m;
  orders.stop_path = false;
  load(0.01, 1.0);
  for (int k = 0; k < 20; ++k)
    EXPECT_EQ(tick().to_m, held) << "a newly loaded reference moves nothing";
}

TEST_F(SyncTest, TakesLongerToStopWhereTheAccelerationLimitDemandsIt) {
  sync.stop_time_s.set(0.05);
  load(0.4, 2.7);  // up to 0.28 m/s; half of 5 m/s2 gives 0.11 s
  ++orders.play;
  for (int k = 0; k < 135; ++k)
    tick();
  orders.stop_path = true;
  double hardest = 0.0;
  while (tick().phase == SyncPhase::Stopping) {
    hardest = std::max(hardest, std::abs(out.to_velocity[0] - out.from_velocity[0]) / 0.01);
  }
  EXPECT_GT(hardest, 2.0);
  EXPECT_LT(hardest, 5.0);
}

TEST_F(SyncTest, StopsByItselfWhenOrdersDoNotComeAnyMore) {
  load(0.04, 2.0);
  ++orders.play;
  for (int k = 0; k < 100; ++k)
    tick();
  orders_come = false;
  for (int k = 0; k < 60; ++k)
    tick();
  EXPECT_EQ(out.phase, SyncPhase::Holding);
  EXPECT_LT(out.path_time_s, 1.5);
}

TEST_F(SyncTest, BeginsNoPathBeforeTheDriversHaveCarriedForAWhile) {
  playAsTheBrakesOpen();
  for (int k = 0; k < 39; ++k)
    EXPECT_NE(tick().phase, SyncPhase::Playing) << k;
  EXPECT_EQ(tick().phase, SyncPhase::Playing);
}

TEST_F(SyncTest, PlaysNothingThatWasStoppedBeforeItBegan) {
  playAsTheBrakesOpen();
  tick();
  orders.stop_path = true;
  for (int k = 0; k < 60; ++k)
    EXPECT_NE(tick().phase, SyncPhase::Playing) << k;
  EXPECT_EQ(out.refused_run, orders.play);
}

TEST_F(SyncTest, ForgetsWhatItPlayedWhenTheDriversAreOff) {
  load(0.04, 2.0);
  ++orders.play;
  for (int k = 0; k < 100; ++k)
    tick();
  orders.drivers_active = false;
  EXPECT_EQ(tick().phase, SyncPhase::Idle);
  orders.drivers_active = true;
  for (int k = 0; k < 5; ++k)
    EXPECT_EQ(tick().phase, SyncPhase::Idle);
}

TEST_F(SyncTest, GoesOnWhereItWasAfterAPauseOfTheMachine) {
  load(0.04, 2.0);
  ++orders.play;
  for (int k = 0; k < 50; ++k)
    tick();
  pause = 500'000'000;  // ten times the time after which silence of the Supervisor counts; tick() checks continuity
  tick();
  EXPECT_EQ(out.phase, SyncPhase::Playing);
  EXPECT_NEAR(out.path_time_s, 0.5, 1e-9);
  for (int k = 0; k < 200; ++k)
    tick();
  EXPECT_EQ(out.phase, SyncPhase::Holding);
  EXPECT_EQ(out.to_m, points.back()) << "the path was not played to its end";
}

TEST_F(SyncTest, HoldsAtOnceAReferenceOfASinglePoint) {
  sync.store().offer(ReferencePath::of({AxisValues{fake::kHome, fake::kHome, fake::kHome, fake::kHome}}));
  ++orders.play;
  EXPECT_EQ(tick().phase, SyncPhase::Holding);
  EXPECT_EQ(out.run, orders.play);
  EXPECT_EQ(out.to_m[1], fake::kHome);
}

}  // namespace
}  // namespace knee_robot::control
