#pragma once

#include <array>
#include <atomic>
#include <vector>

#include "knee_robot/control/hardware_file.h"
#include "knee_robot/control/machine_state.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"

namespace knee_robot::control {

/// Whether a request is possible in a state: the table of the machine. EmergencyStop always is.
bool isPossible(MachineState state, RequestKind request) noexcept;

/// Decides in which state the machine is, and tells Sync, Drivers and AxesOutput what follows from it.
///
///     Disabled --Enable--> Enabling --> Holding --Play--> Playing --Stop--> Stopping --> Holding
///                                                Playing <--Pause, Resume, SetSpeed--> Paused --Stop--> Stopping
///     Disabled --Home--> Enabling --> Homing --all axes found--> SafeStopping --> Disabled, homed
///     Holding --Guide--> Guiding --enabling switch let go, Stop, or HandGuide says so--> Holding
///     any state with drives on --Disable--> SafeStopping --> Disabled
///     any state --fault--> SafeStopping --> Faulted --Reset--> Disabled
///
/// Enabling: 0 V and drives enabled; after their delay the Drivers take over at the measured position while the hold devices are
/// still engaged; when all four loops have been closed and the feedforward has been complete for settle_s, the hold devices are released.
/// Faults: the first one is latched with its axis and component; see faults.h. Components that are watched and do not run, bus
/// failures, the axes' ranges, overruns, the emergency stop's input are looked at here; the Drivers and AxesOutput report theirs.
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

  rt::Property<double> settle_time{*this, "settle_s", 0.05, "s", 0.0, 1.0, "closed loops before the release"};
  rt::Property<double> brake_test{*this,
                                  "brake_test_N",
                                  120.0,
                                  "N",
                                  0.0,
                                  2000.0,
                                  "pushed against each brake at enabling, both ways; 0: not at all"};
  rt::Property<double> brake_slip{*this, "brake_slip_m", 5e-4, "m", 1e-5, 0.01, "that a brake may give way meanwhile"};
  rt::Property<double> enable_limit{*this, "enable_limit_s", 2.0, "s", 0.1, 10.0, "longest enabling"};
  rt::Property<double> range_margin{
      *this, "range_margin_m", 0.005, "m", 0.0, 0.1, "beyond the axes' range before it is a fault"};
  rt::Property<int> stale_measurements{
      *this, "stale_measurements", 3, "cycles", 1, 100, "unreadable encoders in a row: fault"};

  /// Components that must be Running. Before start().
  void watch(const rt::TaskContext& component) { watched_.push_back(&component); }
  /// AxesOutput: watched, too, and when it does not run its stopHook has made the machine safe.
  void watchOutput(const rt::TaskContext& component) {
    output_ = &component;
    watch(component);
  }
  const std::vector<const rt::TaskContext*>& watched() const { return watched_; }
  /// From an activity's thread: too many overruns in a row.
  void reportOverrun() noexcept { overrun_.store(true, std::memory_order_relaxed); }

 protected:
  bool startHook() override;
  void updateHook(const rt::Cycle& cycle) override;

 private:
  void readPorts();
  void lookForFaults();
  void lookAtComponents();
  void lookAtMeasurement();
  void raise(Fault fault, int axis, int component = -1) noexcept;
  void handle(const Request& request, rt::Nanoseconds now);
  void enable(const Request& request, rt::Nanoseconds now);
  void reset(const Request& request);
  void home(const Request& request, rt::Nanoseconds now);
  void guide(const Request& request);
  void readGuide() noexcept;
  void advanceGuiding() noexcept;
  bool brakesWereTested() const noexcept;
  void answer(std::uint32_t number, RequestResult result, int axis = 0, double distance = 0.0) noexcept;
  void settlePending(RequestResult result) noexcept;
  void advance(rt::Nanoseconds now);
  void advanceEnabling(rt::Nanoseconds now);
  bool testBrakes(rt::Nanoseconds now);
  void advancePlaying();
  void answerRefusedPlay() noexcept;
  void advanceSafeStop();
  void advanceHoming(rt::Nanoseconds now);
  bool isQuietForHoming(rt::Nanoseconds now) noexcept;
  void endHoming() noexcept;
  std::uint8_t homingBit() const noexcept;
  void setHome(const AxisValues& lengths, const AxisValues& measured) noexcept;
  void lookAtInputs();
  void lookAtMonitors();
  bool isReady() const noexcept;
  bool causeRemains() const noexcept;
  bool drivesAreOff() const noexcept;
  bool isHomed() const noexcept;
  bool emergencyInput() const noexcept;
  bool inputIsLow(const std::optional<int>& bit) const noexcept;
  void publish(rt::Nanoseconds now);

  const mechanism::Robot robot_;
  const HardwareFile hardware_;
  std::vector<const rt::TaskContext*> watched_;
  const rt::TaskContext* output_ = nullptr;
  std::atomic<bool> overrun_{false};
  const std::array<rt::InputPort<AxisCommand>*, hardware::kAxes> inputs_;

  AxesMeasurement measured_;
  int unreadable_ = 0;
  SetPoint set_point_;
  std::array<AxisCommand, hardware::kAxes> commands_{};
  AxesWritten written_;
  MonitorVerdict verdict_;
  int unjudged_ = 0;  // cycles without a verdict
  Guidance guide_;
  int unguided_ = 0;  // cycles without a word from HandGuide
  bool switch_held_ = false, switch_was_released_ = false;
  bool started_before_ = false;
  bool homing_ = false;             // this enabling leads to Homing
  std::size_t homing_step_ = 0;     // place in the order of axes
  bool homing_axis_begun_ = false;  // its Driver has been asked
  bool home_found_ = false;         // the safe stop that runs is homing's end
  AxisValues quiet_m_{};            // where the axes rest before the next one begins
  AxisValues home_m_{};             // where home was found
  HomeSetting setting_;
  SupervisorStatus status_;
  SupervisorCommand orders_;
  std::uint32_t pending_ = 0;  // request that waits for its answer, 0: none
  rt::Nanoseconds enabling_since_ = 0;
  rt::Nanoseconds step_since_ = 0;  // of the present step of enabling
  AxisValues brake_test_m_{};       // where the axes stood before the brakes are tested
};

}  // namespace knee_robot::control
