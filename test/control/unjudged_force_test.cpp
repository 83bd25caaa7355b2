// The component Monitors: a patient's limit of force that nobody can judge is a fault, not silence; and what stays for
// minutes hides nothing that is worse.
#include <gtest/gtest.h>

#include <functional>

#include "fake_machine.h"
#include "knee_robot/base/constants.h"
#include "src/control/monitors.h"

namespace knee_robot::control {
namespace {

struct MonitorsFeed : rt::TaskContext {
  MonitorsFeed() : rt::TaskContext("MonitorsFeed") {}
  rt::OutputPort<AxesMeasurement> measurement{*this, "measurement", ""};
  rt::OutputPort<AxisCommand> command_1{*this, "command_1", ""}, command_2{*this, "command_2", ""},
      command_3{*this, "command_3", ""}, command_4{*this, "command_4", ""};
  rt::OutputPort<AxesWritten> written{*this, "written", ""};
  rt::OutputPort<Disturbance> disturbance{*this, "disturbance", ""};
  rt::InputPort<MonitorVerdict> verdict{*this, "verdict", ""};
};

class UnjudgedForce : public ::testing::Test {
 protected:
  UnjudgedForce() {
    rt::connect(feed.measurement, monitors.measurement);
    rt::connect(feed.command_1, monitors.command_1);
    rt::connect(feed.command_2, monitors.command_2);
    rt::connect(feed.command_3, monitors.command_3);
    rt::connect(feed.command_4, monitors.command_4);
    rt::connect(feed.written, monitors.written);
    rt::connect(feed.disturbance, monitors.disturbance);
    rt::connect(monitors.verdict, feed.verdict);
    EXPECT_TRUE(monitors.configure() && monitors.start());
    patient.given = true;
    patient.force_N = 60.0;
    measured.status = hardware::IoStatus::Ok;
    measured.position_m.fill(fake::kHome);
    written.level = DriveLevel::Released;
    disturbed.identified = disturbed.known = true;
  }
  void run(double seconds) {
    monitors.setPatient(patient);
    for (int k = 0; k < static_cast<int>(1000 * seconds); ++k) {
      ++measured.sequence;
      measured.time = measured.read_at = measured.read_at + 1'000'000;
      feed.measurement.write(measured);
      for (rt::OutputPort<AxisCommand>* command : {&feed.command_1, &feed.command_2, &feed.command_3, &feed.command_4})
        command->write(holding());
      if (each_ms) each_ms();
      feed.written.write(written);
      const bool speaks = !silent && measured.sequence % observed_every == 0;
      if (speaks) disturbed.sequence = measured.sequence - (behind ? 1 : 0);
      if (speaks) feed.disturbance.write(disturbed);
      rt::Cycle cycle;
      cycle.time = measured.time;
      monitors.update(cycle);
      feed.verdict.read(verdict);
    }
  }
  static AxisCommand holding() {
    AxisCommand command;
    command.active = true;
    command.reference_m = fake::kHome;
    return command;
  }

  static mechanism::Robot withHotMotors() {
    mechanism::Robot robot = fake::robot();
    for (mechanism::Actuator& actuator : robot.actuators)
      actuator.force_continuous_N = 100.0;
    return robot;
  }

  Monitors monitors{"Monitors", withHotMotors()};
  MonitorsFeed feed;
  PatientRange patient;
  AxesMeasurement measured;
  AxesWritten written;
  Disturbance disturbed;
  MonitorVerdict verdict;
  bool silent = false, behind = false;
  std::uint64_t observed_every = 1;  // measurements
  std::function<void()> each_ms;
};

using HotMotor = UnjudgedForce;

TEST_F(HotMotor, HidesNoAxisThatRunsAwayWhileItIsBroughtToRest) {
  patient.given = false;
  written.force_N[0] = 150.0;
  run(320.0);
  ASSERT_EQ(verdict.fault[0], Fault::ThermalOverload);
  each_ms = [this] {  // ever faster, although the loop pushes back
    written.safe_stop = SafeStopPhase::Decelerating;
    measured.velocity_m_per_s[0] += 0.002;
    measured.position_m[0] += 1e-3 * measured.velocity_m_per_s[0];
    written.force_N[0] = std::max(-250.0, written.force_N[0] - 5.0);
  };
  run(0.15);
  EXPECT_EQ(verdict.fault[0], Fault::Runaway) << describe(verdict.fault[0]).name;
}

TEST_F(UnjudgedForce, IsAFaultAfterASecondWhenTheForcesAreNotKnownAnyMore) {
  run(5.0);
  EXPECT_EQ(verdict.fault[0], Fault::None);
  disturbed.known = false;
  disturbed.wrench.fill(1e3);
  run(0.95);
  EXPECT_EQ(verdict.fault[0], Fault::None) << "filters settle";
  run(0.1);
  EXPECT_EQ(verdict.fault[0], Fault::MonitorsStale);
  EXPECT_TRUE(concernsAllAxes(Fault::MonitorsStale));
}

TEST_F(UnjudgedForce, IsAFaultWhenTheObserverIsSilent) {
  run(1.0);
  silent = true;
  run(1.1);
  EXPECT_EQ(verdict.fault[0], Fault::MonitorsStale);
}

TEST_F(UnjudgedForce, IsAFaultWithoutAModel) {
  disturbed.identified = false;
  run(1.5);
  EXPECT_EQ(verdict.fault[0], Fault::MonitorsStale);
}

TEST_F(UnjudgedForce, IsNoneWhereTheObserverRunsBehindTheMonitors) {
  behind = true;
  run(3.0);
  EXPECT_EQ(verdict.fault[0], Fault::None);
  disturbed.wrench[0] = 70.0;
  run(0.1);
  EXPECT_EQ(verdict.fault[0], Fault::PatientForce);
}

TEST_F(UnjudgedForce, IsNoneWhereTheObserverIsSlowerThanTheMonitorsWhichStillSeeAPush) {
  observed_every = 5;  // its period_s in the deployment file
  run(3.0);
  EXPECT_EQ(verdict.fault[0], Fault::None);
  disturbed.wrench[0] = 70.0;
  run(0.1);
  EXPECT_EQ(verdict.fault[0], Fault::PatientForce);
}

TEST_F(UnjudgedForce, IsNoneWhereNobodyLimitsItOrTheDrivesDoNotCarry) {
  disturbed.known = false;
  written.safe_stop = SafeStopPhase::Engaging;
  run(3.0);
  EXPECT_EQ(verdict.fault[0], Fault::None);
  written.safe_stop = SafeStopPhase::Idle;
  patient.force_N = PatientRange{}.force_N;
  run(3.0);
  EXPECT_EQ(verdict.fault[0], Fault::None);
  patient.given = false;
  patient.force_N = 60.0;
  run(3.0);
  EXPECT_EQ(verdict.fault[0], Fault::None);
}

}  // namespace
}  // namespace knee_robot::control
