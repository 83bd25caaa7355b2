// The Supervisor alone, fed by hand: what it decides about what others report.
#include "src/control/supervisor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "fake_machine.h"

namespace knee_robot::control {
namespace {

struct SupervisorFeed : rt::TaskContext {
  SupervisorFeed() : rt::TaskContext("SupervisorFeed") {}
  rt::OutputPort<AxesMeasurement> measurement{*this, "measurement", ""};
  rt::OutputPort<SetPoint> set_point{*this, "set_point", ""};
  rt::OutputPort<AxisCommand> command_1{*this, "command_1", ""}, command_2{*this, "command_2", ""},
      command_3{*this, "command_3", ""}, command_4{*this, "command_4", ""};
  rt::OutputPort<AxesWritten> written{*this, "written", ""};
  rt::OutputPort<MonitorVerdict> verdict{*this, "verdict", ""};
  rt::OutputPort<Request> request{*this, "request", ""};
  rt::InputPort<SupervisorCommand> orders{*this, "orders", ""};
  rt::InputPort<SupervisorStatus> status{*this, "status", ""};
};

/// A machine that obeys at once: outputs climb as ordered, Drivers are active when they should be.
class SupervisorTest : public ::testing::Test {
 protected:
  void SetUp() override {
    rt::connect(feed.measurement, supervisor.measurement);
    rt::connect(feed.set_point, supervisor.set_point);
    rt::connect(feed.command_1, supervisor.command_1);
    rt::connect(feed.command_2, supervisor.command_2);
    rt::connect(feed.command_3, supervisor.command_3);
    rt::connect(feed.command_4, supervisor.command_4);
    rt::connect(feed.written, supervisor.written);
    rt::connect(feed.verdict, supervisor.verdict);
    rt::connect(feed.request, supervisor.request, rt::ConnPolicy::buffer(4));
    rt::connect(supervisor.orders, feed.orders);
    rt::connect(supervisor.status, feed.status);
    ASSERT_TRUE(supervisor.configure() && supervisor.start());
    measured.status = hardware::IoStatus::Ok;
    measured.position_m.fill(fake::kHome);
    cycles(2);
  }
  void cycle() {
    now += 1'000'000;
    ++measured.sequence;
    measured.time = now;
    feed.measurement.write(measured);
    feed.set_point.write(set_point);
    AxisCommand command;
    command.time = now;
    command.active = orders.drivers_active;
    rt::OutputPort<AxisCommand>* commands[] = {&feed.command_1, &feed.command_2, &feed.command_3, &feed.command_4};
    for (int i = 0; i < 4; ++i) {
      command.axis = i + 1;
      commands[i]->write(command);
    }
    verdict.sequence = measured.sequence;
    if (monitors_live) feed.verdict.write(verdict);
    feed.written.write(written);
    rt::Cycle cycle;
    cycle.time = now;
    cycle.wake = now + late;
    cycle.period = 1'000'000;
    supervisor.update(cycle);
    feed.orders.read(orders);
    feed.status.read(status);
    written.sequence = measured.sequence;
    written.status = hardware::IoStatus::Ok;
    written.level = orders.safe_stop ? DriveLevel::Off : orders.level;
    written.safe_stop = orders.safe_stop ? SafeStopPhase::Done : SafeStopPhase::Idle;
  }
  void cycles(int count) {
    for (int i = 0; i < count; ++i)
      cycle();
  }
  RequestResult ask(RequestKind kind, double value = 0.0) {
    Request request;
    request.number = ++number;
    request.kind = kind;
    request.value = value;
    feed.request.write(request);
    cycle();
    const RequestAnswer& answer = status.answers[number % SupervisorStatus::kAnswers];
    return answer.number == number ? answer.result : RequestResult::Superseded;
  }
  /// The servo cycle stands still for 200 ms; so many cycles later an axis stalls.
  void stallAfterPause(int later) {
    now += 200'000'000;
    cycles(later);
    verdict.fault[2] = Fault::Stalled;
    cycle();
  }
  void play() {
    ask(RequestKind::Enable);
    cycles(800);  // the test of the brakes takes 400
    ASSERT_EQ(status.state, MachineState::Holding);
    ask(RequestKind::Play);
    set_point.run = orders.play;
    set_point.phase = SyncPhase::Playing;
    cycles(3);
    ASSERT_EQ(status.state, MachineState::Playing);
  }

  Supervisor supervisor{"Supervisor", fake::robot(), fake::hardware()};
  SupervisorFeed feed;
  AxesMeasurement measured;
  SetPoint set_point;
  AxesWritten written;
  MonitorVerdict verdict;
  SupervisorCommand orders;
  SupervisorStatus status;
  bool monitors_live = true;
  rt::Nanoseconds now = 0;
  rt::Nanoseconds late = 0;  // how much the cycles are
  std::uint32_t number = 0;
};

TEST_F(SupervisorTest, DoesNothingThatNobodyWaitsForAnyMoreExceptStopping) {
  Request request;
  request.kind = RequestKind::Enable;
  request.number = ++number;
  request.expires = now + 500'000'000;
  late = 600'000'000;  // a cycle that was due in time, and was executed behind a pause of the process
  feed.request.write(request);
  cycles(3);
  EXPECT_EQ(status.answers[number].result, RequestResult::TooLate);
  EXPECT_EQ(status.state, MachineState::Disabled);
  EXPECT_EQ(orders.level, DriveLevel::Off);
  late = 0;
  ASSERT_NO_FATAL_FAILURE(play());
  request.kind = RequestKind::Stop;
  request.number = ++number;
  request.expires = 0;
  feed.request.write(request);
  cycle();
  EXPECT_EQ(status.state, MachineState::Stopping);
}

TEST_F(SupervisorTest, SlowsDownHoweverLateItHearsOfItButGetsNoFaster) {
  ASSERT_NO_FATAL_FAILURE(play());
  Request request;
  request.kind = RequestKind::SetSpeed;
  const auto askLate = [&](double speed) {
    request.number = ++number;
    request.value = speed;
    request.expires = now;
    late = 600'000'000;
    feed.request.write(request);
    cycle();
    return status.answers[number % SupervisorStatus::kAnswers].result;
  };
  EXPECT_EQ(askLate(0.5), RequestResult::Done);
  EXPECT_EQ(askLate(0.0), RequestResult::Done) << "0 pauses (docs/ros_interface.md)";
  EXPECT_EQ(orders.speed, 0.0);
  EXPECT_EQ(askLate(1.0), RequestResult::TooLate);
  EXPECT_EQ(askLate(std::nan("")), RequestResult::TooLate);
  EXPECT_EQ(orders.speed, 0.0);
}

TEST_F(SupervisorTest, StartsAnewWithoutWhatWasAskedOfTheOneThatFailed) {
  Request request;
  request.kind = RequestKind::Enable;
  request.number = ++number;
  feed.request.write(request);
  static_cast<rt::TaskContext&>(supervisor).stop();
  ASSERT_TRUE(supervisor.start());
  cycles(3);
  EXPECT_EQ(status.answers[number].result, RequestResult::Failed);
  EXPECT_EQ(status.state, MachineState::Disabled);
  EXPECT_EQ(orders.level, DriveLevel::Off);
}

TEST_F(SupervisorTest, TakesAPathThatSyncBrokeOffByItselfForAFaultAndNotForItsEnd) {
  ASSERT_NO_FATAL_FAILURE(play());
  set_point.phase = SyncPhase::Stopping;  // nobody has asked for it: Sync does not hear the orders any more
  cycle();
  EXPECT_EQ(status.fault, Fault::OrdersStale);
  EXPECT_EQ(status.state, MachineState::SafeStopping);
  EXPECT_TRUE(orders.safe_stop);
  cycles(3);
  EXPECT_EQ(status.state, MachineState::Faulted);
}

TEST_F(SupervisorTest, TakesThePhaseStoppingForWhatItIsWhenItWasAskedFor) {
  ASSERT_NO_FATAL_FAILURE(play());
  EXPECT_EQ(ask(RequestKind::Stop), RequestResult::Done);
  EXPECT_TRUE(orders.stop_path);
  set_point.phase = SyncPhase::Stopping;
  cycles(3);
  EXPECT_EQ(status.state, MachineState::Stopping);
  set_point.phase = SyncPhase::Holding;
  cycles(2);
  EXPECT_EQ(status.state, MachineState::Holding);
  EXPECT_EQ(status.fault, Fault::None);
}

TEST_F(SupervisorTest, AnswersEveryDisableWhenTheDrivesAreOffWhoeverPressesStopMeanwhile) {
  ASSERT_NO_FATAL_FAILURE(play());
  ask(RequestKind::Disable);
  const std::uint32_t first = number;
  EXPECT_EQ(status.state, MachineState::SafeStopping);
  EXPECT_EQ(ask(RequestKind::Stop), RequestResult::Done);
  ask(RequestKind::Disable);
  const std::uint32_t second = number;
  cycles(3);
  EXPECT_EQ(status.state, MachineState::Disabled);
  for (const std::uint32_t one : {first, second}) {
    EXPECT_EQ(status.answers[one % SupervisorStatus::kAnswers].number, one);
    EXPECT_EQ(status.answers[one % SupervisorStatus::kAnswers].result, RequestResult::Done);
  }
}

TEST_F(SupervisorTest, NoticesThatTheMonitorsAreSilentWithinThreeCycles) {
  ASSERT_NO_FATAL_FAILURE(play());
  monitors_live = false;
  cycles(3);
  EXPECT_EQ(status.fault, Fault::MonitorsStale);
}

TEST_F(SupervisorTest, NamesTheAxisOfAMonitorsFaultAndNoneForThoseOfThePlatform) {
  ASSERT_NO_FATAL_FAILURE(play());
  verdict.fault[2] = Fault::Stalled;
  cycle();
  EXPECT_EQ(status.fault, Fault::Stalled);
  EXPECT_EQ(status.fault_axis, 3);
  EXPECT_TRUE(concernsAllAxes(Fault::PatientSpeed));
}

TEST_F(SupervisorTest, SaysOfAFaultThatTheServoCycleStoodStillShortlyBefore) {
  ASSERT_NO_FATAL_FAILURE(play());
  stallAfterPause(100);
  EXPECT_EQ(status.fault, Fault::Stalled);
  EXPECT_NEAR(status.fault_paused_s, 0.201, 1e-9);
}

TEST_F(SupervisorTest, BlamesNoPauseForWhatHappensLongAfterIt) {
  ASSERT_NO_FATAL_FAILURE(play());
  stallAfterPause(600);
  EXPECT_EQ(status.fault, Fault::Stalled);
  EXPECT_EQ(status.fault_paused_s, 0.0);
}

TEST_F(SupervisorTest, BlamesNoPauseForAnEmergencyStopThatSomebodyPressed) {
  ASSERT_NO_FATAL_FAILURE(play());
  now += 200'000'000;
  cycle();
  ask(RequestKind::EmergencyStop);
  EXPECT_EQ(status.fault, Fault::EmergencyStop);
  EXPECT_EQ(status.fault_paused_s, 0.0);
}

TEST_F(SupervisorTest, SlowsDownUnlessTheMachineIsTakenFromItAsTheTableSays) {
  struct Stop {
    Fault fault;
    bool immediate;
    std::function<void()> happens;
  };
  const Stop stops[] = {
      {Fault::EmergencyStop, false, [&] { ask(RequestKind::EmergencyStop); }},  // the service takes no power
      {Fault::Stalled, false, [&] { verdict.fault[2] = Fault::Stalled; }},
      {Fault::GuardianActed, true, [&] { measured.fenced_out = true; }},
  };
  for (const auto& [fault, immediate, happens] : stops) {
    ASSERT_NO_FATAL_FAILURE(play());
    happens();
    cycle();
    EXPECT_EQ(status.fault, fault);
    EXPECT_EQ(orders.immediate, immediate) << describe(fault).name;
    verdict.fault[2] = Fault::None;
    set_point.phase = SyncPhase::Idle;
    cycles(3);
    ask(RequestKind::Reset);
  }
}

TEST_F(SupervisorTest, DoesNotResetAMotorThatIsStillHot) {
  verdict.fault[1] = Fault::ThermalOverload;
  verdict.heat[1] = 1.01;
  cycle();
  ASSERT_EQ(status.state, MachineState::Faulted);
  verdict.fault[1] = Fault::None;
  verdict.heat[1] = 0.9;
  EXPECT_EQ(ask(RequestKind::Reset), RequestResult::CauseRemains);
  verdict.heat[1] = 0.79;
  EXPECT_EQ(ask(RequestKind::Reset), RequestResult::Done);
  EXPECT_EQ(status.state, MachineState::Disabled);
}

TEST_F(SupervisorTest, PassesTheSpeedOnAndRefusesWhatIsNone) {
  EXPECT_EQ(ask(RequestKind::SetSpeed, 0.4), RequestResult::Done);
  EXPECT_DOUBLE_EQ(orders.speed, 0.4);
  EXPECT_EQ(ask(RequestKind::SetSpeed, std::nan("")), RequestResult::OutOfRange);
  EXPECT_EQ(ask(RequestKind::SetSpeed, 1.01), RequestResult::OutOfRange);
  EXPECT_EQ(ask(RequestKind::SetSpeed, -0.01), RequestResult::OutOfRange);
  EXPECT_DOUBLE_EQ(orders.speed, 0.4);
}

TEST_F(SupervisorTest, KeepsTheSpeedWhenItIsStartedAnew) {
  ASSERT_EQ(ask(RequestKind::SetSpeed, 0.1), RequestResult::Done);
  static_cast<rt::TaskContext&>(supervisor).stop();
  ASSERT_TRUE(supervisor.start());
  cycles(2);
  EXPECT_DOUBLE_EQ(orders.speed, 0.1) << "the next movement would be ten times as fast as the last";
}

TEST_F(SupervisorTest, KeepsTheFirstFaultWhateverFollows) {
  ASSERT_NO_FATAL_FAILURE(play());
  verdict.fault[0] = Fault::Saturated;
  cycle();
  verdict.fault[3] = Fault::EncoderJump;
  measured.status = hardware::IoStatus::Disconnected;
  cycles(10);
  EXPECT_EQ(status.fault, Fault::Saturated);
  EXPECT_EQ(status.fault_axis, 1);
}

}  // namespace
}  // namespace knee_robot::control
