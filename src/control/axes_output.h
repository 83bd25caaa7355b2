#pragma once

#include <array>

#include "carried_load.h"
#include "knee_robot/control/axis_data.h"
#include "knee_robot/control/hardware_file.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"
#include "safe_stop.h"
#include "safety_inputs.h"

namespace knee_robot::control {

/// Last in the servo cycle, and the only place that writes to the machine. Once a cycle: four set values at once, the
/// digital outputs, the heartbeat toggled.
///
/// Below HeldByDrivers 0 V are written. From there on each axis gets its Driver's command as long as it is fresh,
/// finite, of this axis, its loop is closed and no monitor says that it must not go on; clamped to voltage_max and
/// force_max here once more. Otherwise the axis gets its load estimate (CarriedLoad): the low-passed command of the last
/// 0.2 s, which is about what carries the platform there, until the holding brake holds it.
///
/// The safe stop (SafeStop) is run here on all four channels, once, when the Supervisor orders it, when a loop is not
/// closed although it should be, when orders are stale or go down a level, when the bus refuses. Leaving Running in any
/// other way (stopHook) engages the holding brakes, disables the drives and writes 0 V at once, without waiting: nobody
/// would call again.
class AxesOutput : public rt::TaskContext {
 public:
  AxesOutput(const std::string& name, const mechanism::Robot& robot, const HardwareFile& hardware,
             hardware::AxisBus& bus);

  rt::InputPort<SupervisorCommand> orders{*this, "orders", "from the Supervisor"};
  rt::InputPort<AxesMeasurement> measurement{*this, "measurement", "from AxesInput"};
  rt::InputPort<MonitorVerdict> verdict{*this, "verdict", "from Monitors"};
  rt::InputPort<AxisCommand> command_1{*this, "command_1", "from the Driver of axis 1"};
  rt::InputPort<AxisCommand> command_2{*this, "command_2", "from the Driver of axis 2"};
  rt::InputPort<AxisCommand> command_3{*this, "command_3", "from the Driver of axis 3"};
  rt::InputPort<AxisCommand> command_4{*this, "command_4", "from the Driver of axis 4"};
  rt::OutputPort<AxesWritten> written{*this, "written", "what the machine got"};

  rt::Property<double> command_timeout{*this, "command_timeout_s", 0.0025, "s", 0.001, 0.1, "older commands are stale"};
  rt::Property<double> orders_timeout{*this, "orders_timeout_s", 0.0025, "s", 0.001, 0.1, "older orders are stale"};
  rt::Property<double> decelerate_limit{
      *this, "decelerate_limit_s", 1.0, "s", 0.0, 5.0, "longest time to come to rest in a safe stop"};
  rt::Property<double> settle_time{*this, "settle_s", 0.05, "s", 0.0, 1.0, "rest before the brakes engage"};
  rt::Property<double> transfer_time{*this,
                                     "transfer_s",
                                     0.08,
                                     "s",
                                     0.0,
                                     5.0,
                                     "time in which the load is handed over to the brakes; 0: at once, unwatched"};
  rt::Property<double> slip{*this, "slip_m", 5e-4, "m", 1e-5, 0.01, "motion meanwhile: its brake does not hold"};

 protected:
  bool configureHook() override;
  bool startHook() override;
  void updateHook(const rt::Cycle& cycle) override;
  void stopHook() override;

 private:
  void readCommands(const rt::Cycle& cycle);
  Fault checkCommand(const AxisCommand& command, std::size_t axis, const rt::Cycle& cycle) const noexcept;
  void heedDrives(const AxesMeasurement& measured) noexcept;
  void leaveLost(const hardware::BusFailure& failure) noexcept;
  void followOrders(const rt::Cycle& cycle);
  void beginSafeStop(Fault fault, int axis, rt::Nanoseconds now) noexcept;
  bool isAtRest() const noexcept;
  void runSafeStop(const rt::Cycle& cycle, const AxesMeasurement& measured);
  std::uint32_t transferNumber(const rt::Cycle& cycle) noexcept;
  bool slips(const AxesMeasurement& measured) noexcept;
  bool creeps(const AxesMeasurement& measured, rt::Nanoseconds now) noexcept;
  bool stands(const AxesMeasurement& measured) const noexcept;
  bool runs(const AxesMeasurement& measured) noexcept;
  AxisValues chooseVolts() const noexcept;
  double voltsOf(double force_N, std::size_t axis) const noexcept;
  double clamped(double volts, std::size_t axis) const noexcept;
  void writeVolts(const AxisValues& volts, rt::Nanoseconds now);
  void writeOutputs(rt::Nanoseconds now);
  void estimateLoad(const AxesMeasurement& measured, double dt) noexcept;
  void findMass(double dt) noexcept;
  void offerLoad() noexcept;
  void testBrakes(AxisValues& volts) const noexcept;

  const mechanism::Robot robot_;
  const HardwareFile hardware_;
  const SafetyInputs lines_{hardware_};
  hardware::AxisBus& bus_;
  const std::array<rt::InputPort<AxisCommand>*, hardware::kAxes> inputs_;
  SafeStop safe_stop_{SafeStopTiming{}};
  SupervisorCommand order_;
  bool heard_ = false;
  std::array<AxisCommand, hardware::kAxes> commands_{};
  MonitorVerdict verdict_;
  std::array<bool, hardware::kAxes> closed_{};
  std::array<bool, hardware::kAxes> astray_{};  // it ran away: its force may have the wrong sign
  std::array<bool, hardware::kAxes> blind_{};   // its encoder is the fault, or may be
  std::array<bool, hardware::kAxes> begins_{};  // since this cycle
  bool all_closed_ = false;
  bool watched_ = false;  // a loop is left whose drive can be reached
  int open_axis_ = 0;
  Fault open_fault_ = Fault::None;
  std::array<CarriedLoad, hardware::kAxes> load_{};
  double released_s_ = 0.0;  // for so long the holding brakes have been ordered to let go
  AxisValues mean_m_{};      // positions; where the encoder is the fault their mean over some 20 ms
  AxisValues transfer_m_{};  // where the axes stood when the transfer began
  AxisValues braked_m_{};    // where they were when the brakes should have held
  AxisValues creep_m_{};     // where they stood at creep_at_
  rt::Nanoseconds creep_at_ = 0;
  bool creeps_ = false;
  rt::Nanoseconds asked_at_ = 0;
  std::uint32_t own_transfers_ = 0;
  bool power_was_lost_ = false;  // while the drives carried
  bool power_came_back_ = false;
  bool outputs_refused_ = false;
  bool lost_at_rest_ = false;  // the references stood still when the outputs began to be refused
  bool heartbeat_ = false;
  AxesWritten out_;
};

}  // namespace knee_robot::control
