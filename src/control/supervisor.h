#pragma once

#include <array>
#include <atomic>
#include <vector>

#include "component_watch.h"
#include "enabling_sequence.h"
#include "fault_latch.h"
#include "fault_search.h"
#include "guiding_permission.h"
#include "held_place.h"
#include "homing_sequence.h"
#include "knee_robot/control/hardware_file.h"
#include "knee_robot/control/machine_state.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"
#include "lost_counts.h"
#include "request_answers.h"
#include "safety_inputs.h"
#include "supervisor_view.h"

namespace knee_robot::control {

/// Decides in which state the machine is, and tells Sync, Drivers and AxesOutput what follows from it.
///
///     Disabled --Enable--> Enabling --> Holding --Play--> Playing --Stop--> Stopping --> Holding
///                                                Playing <--Pause, Resume, SetSpeed--> Paused --Stop--> Stopping
///     Disabled --Home--> Enabling --> Homing --all axes found--> SafeStopping --> Disabled, homed
///     Holding --Guide--> Guiding --enabling switch let go, Stop, or HandGuide says so--> Holding
///     any state with drives on --Disable--> SafeStopping --> Disabled
///     any state --fault--> SafeStopping --> Faulted --Reset--> Disabled
///
/// Here are the states and what leads from one to the next. What is asked about the machine on the way is asked of:
/// EnablingSequence (how the drives come on), HomingSequence (where the axes are), GuidingPermission (whether a hand
/// may guide), FaultSearch (what is wrong), FaultLatch (what was wrong first), LostCounts (which axes have to
/// be homed again), HeldPlace (whether the brakes hold with the drives off), RequestAnswers (who still waits for an
/// answer).
class Supervisor : public rt::TaskContext {
 public:
  Supervisor(const std::string& name, const mechanism::Robot& robot, const HardwareFile& hardware);

  rt::InputPort<AxesMeasurement> measurement{*this, "measurement", "from AxesInput"};
  rt::InputPort<SetPoint> set_point{*this, "set_point", "from Sync"};
  rt::InputPort<AxisCommand> command_1{*this, "command_1", "from the Driver of axis 1"};
  rt::InputPort<AxisCommand> command_2{*this, "command_2", "from the Driver of axis 2"};
  rt::InputPort<AxisCommand> command_3{*this, "command_3", "from the Driver of axis 3"};
  rt::InputPort<AxisCommand> command_4{*this, "command_4", "from the Driver of axis 4"};
  rt::InputPort<AxesWritten> written{*this, "written", "from AxesOutput, of the last cycle"};
  rt::InputPort<MonitorVerdict> verdict{*this, "verdict", "from Monitors, of this cycle"};
  rt::InputPort<Guidance> guidance{*this, "guidance", "from HandGuide", rt::Need::Optional};
  rt::InputPort<Request> request{*this, "request", "from the operator", rt::Need::Optional};
  rt::OutputPort<SupervisorCommand> orders{*this, "orders", "to Sync, Drivers and AxesOutput"};
  rt::OutputPort<HomeSetting> home_setting{*this, "home", "to AxesInput: shifts the lengths"};
  rt::OutputPort<SupervisorStatus> status{*this, "status", "for the operator"};

  rt::Property<double> settle_time{
      *this, "settle_s", 0.05, "s", 0.0, 1.0, "time with closed loops before the brakes are released"};
  rt::Property<double> brake_test{*this,
                                  "brake_test_N",
                                  120.0,
                                  "N",
                                  0.0,
                                  2000.0,
                                  "force with which each brake is tested at enabling, in both directions; 0: no test"};
  rt::Property<double> brake_slip{
      *this, "brake_slip_m", 5e-4, "m", 1e-5, 0.01, "motion in this test that means the brake does not hold"};
  rt::Property<double> enable_limit{*this, "enable_limit_s", 2.0, "s", 0.1, 10.0, "longest duration of enabling"};
  rt::Property<double> range_margin{
      *this, "range_margin_m", 0.005, "m", 0.0, 0.1, "distance beyond the axes' range that is a fault"};
  rt::Property<int> stale_measurements{
      *this, "stale_measurements", 3, "cycles", 1, 100, "unreadable measurements in a row that are a fault"};

  /// Components that must be Running. Before start().
  void watch(const rt::TaskContext& component) { components_.add(component); }
  /// AxesOutput: watched, too, and when it does not run its stopHook has made the machine safe.
  void watchOutput(const rt::TaskContext& component) {
    output_ = &component;
    watch(component);
  }
  const std::vector<const rt::TaskContext*>& watched() const { return components_.all(); }
  /// From an activity's thread: too many overruns in a row.
  void reportOverrun() noexcept { overrun_.store(true, std::memory_order_relaxed); }

 protected:
  bool startHook() override;
  void updateHook(const rt::Cycle& cycle) override;

 private:
  void readPorts();
  void detectFaults(rt::Nanoseconds now);
  void noticePause(const rt::Cycle& cycle) noexcept;
  void raise(FaultCause cause) noexcept;
  void handle(const Request& request, const rt::Cycle& cycle);
  void enable(const Request& request, rt::Nanoseconds now);
  void disable(const Request& request) noexcept;
  void play(const Request& request) noexcept;
  void stop(const Request& request) noexcept;
  void reset(const Request& request) noexcept;
  void home(const Request& request, rt::Nanoseconds now);
  void guide(const Request& request) noexcept;
  void advance(rt::Nanoseconds now);
  void advanceEnabling(rt::Nanoseconds now);
  void advancePlaying();
  void advanceHoming(rt::Nanoseconds now);
  void advanceSafeStop();
  bool isReady() const noexcept;
  void publish(rt::Nanoseconds now);
  void publishOrders(rt::Nanoseconds now);
  void publishStatus(rt::Nanoseconds now);

  const mechanism::Robot robot_;
  const HardwareFile hardware_;
  const std::array<rt::InputPort<AxisCommand>*, hardware::kAxes> drivers_;
  const rt::TaskContext* output_ = nullptr;
  std::atomic<bool> overrun_{false};

  SupervisorView view_;
  SafetyInputs inputs_;
  ComponentWatch components_;
  FaultSearch search_;
  FaultLatch fault_;
  LostCounts lost_counts_;
  HeldPlace held_place_;
  EnablingSequence enabling_;
  HomingSequence homing_;
  GuidingPermission guiding_;
  RequestAnswers answers_;

  /// The servo cycle stood still; what goes wrong shortly after it may be its consequence.
  struct Pause {
    double length_s = 0.0;
    rt::Nanoseconds end = 0;
  };
  Pause pause_;
  rt::Nanoseconds last_cycle_ = 0;

  bool started_before_ = false;
  MachineState state_ = MachineState::Disabled;
  SupervisorCommand orders_;
};

}  // namespace knee_robot::control
