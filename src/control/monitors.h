#pragma once

#include <array>
#include <mutex>

#include "knee_robot/control/axis_data.h"
#include "knee_robot/rt/channel.h"
#include "knee_robot/rt/operation.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"
#include "monitor_acceleration.h"
#include "monitor_encoder_frozen.h"
#include "monitor_encoder_jump.h"
#include "monitor_encoder_leap.h"
#include "monitor_encoder_noise.h"
#include "monitor_patient.h"
#include "monitor_runaway.h"
#include "monitor_saturation.h"
#include "monitor_soft_limit.h"
#include "monitor_stall.h"
#include "monitor_thermal.h"
#include "monitor_velocity.h"
#include "monitor_weight.h"

namespace knee_robot::control {

/// Looks at all four axes once a servo cycle, after the Drivers and before the Supervisor and AxesOutput, so that a
/// fault acts in the cycle in which it is seen. The limits' meaning is in the monitor_*.h, one file each. Encoder jump
/// and heat are evaluated always; the others while the Drivers carry the platform (released, no safe stop running);
/// soft limits and the patient's only when homed, and of an axis that looks for home only speed, acceleration and heat.
/// The first fault of an axis is kept until the Drivers are switched off.
///
/// The following error is the Driver's; range (hard), readability of the encoders, components and inputs are the
/// Supervisor's.
class Monitors : public rt::TaskContext {
 public:
  Monitors(const std::string& name, const mechanism::Robot& robot);

  rt::InputPort<AxesMeasurement> measurement{*this, "measurement", "from AxesInput"};
  rt::InputPort<AxisCommand> command_1{*this, "command_1", "from the Driver of axis 1"};
  rt::InputPort<AxisCommand> command_2{*this, "command_2", "from the Driver of axis 2"};
  rt::InputPort<AxisCommand> command_3{*this, "command_3", "from the Driver of axis 3"};
  rt::InputPort<AxisCommand> command_4{*this, "command_4", "from the Driver of axis 4"};
  rt::InputPort<AxesWritten> written{*this, "written", "from AxesOutput, of the last cycle"};
  rt::InputPort<Disturbance> disturbance{*this, "disturbance", "from the DisturbanceObserver", rt::Need::Optional};
  rt::OutputPort<MonitorVerdict> verdict{*this, "verdict", "to the Supervisor and AxesOutput"};

  rt::Property<double> jump_factor{
      *this, "jump_factor", 4.0, "", 1.0, 100.0, "encoder jump: largest change, times velocity_max and the cycle time"};
  rt::Property<double> jump_floor{*this, "jump_floor_m", 1e-3, "m", 1e-5, 0.1, "encoder jump: added to it"};
  rt::Property<double> jump_gap{
      *this, "jump_gap_m", 5e-3, "m", 1e-3, 0.1, "encoder jump: largest change while the encoders could not be read"};
  rt::Property<double> jump_acceleration{*this,
                                         "jump_acceleration_m_per_s2",
                                         200.0,
                                         "m/s^2",
                                         50.0,
                                         1e6,
                                         "encoder jump: from rest, or beyond jump_factor times the speed of the last "
                                         "moments; no force accelerates an axis like that"};
  rt::Property<double> frozen_distance{
      *this, "frozen_distance_m", 0.002, "m", 1e-4, 0.1, "frozen encoder: motion of the reference"};
  rt::Property<double> frozen_share{
      *this,
      "frozen_share",
      0.35,
      "",
      0.0,
      1.0,
      "frozen encoder: change of the force meanwhile, share of the force limit; more than friction takes"};
  rt::Property<double> frozen_force{
      *this, "frozen_force_N", 200.0, "N", 1.0, 5000.0, "frozen encoder: upper limit of that change"};
  rt::Property<double> soft_margin{
      *this, "soft_margin_m", 5e-4, "m", 0.0, 0.05, "soft limit: distance beyond the robot file's range"};
  rt::Property<double> soft_speed{
      *this, "soft_speed_m_per_s", 2e-3, "m/s", 0.0, 0.1, "soft limit: outward speed from which it is a fault"};
  rt::Property<double> velocity_factor{
      *this, "velocity_factor", 1.3, "", 1.0, 10.0, "velocity limit, times velocity_max"};
  rt::Property<double> velocity_floor{
      *this, "velocity_floor_m_per_s", 0.02, "m/s", 0.0, 1.0, "velocity limit: added to it, for noise"};
  rt::Property<double> velocity_time{
      *this, "velocity_s", 0.005, "s", 0.0, 1.0, "velocity limit: time above it that is a fault"};
  rt::Property<double> acceleration_factor{
      *this, "acceleration_factor", 3.0, "", 1.0, 100.0, "acceleration limit, times acceleration_max"};
  rt::Property<double> stall_share{*this, "stall_share", 0.6, "", 0.05, 1.0, "stall: force, share of the force limit"};
  rt::Property<double> stall_speed{
      *this, "stall_speed_m_per_s", 1e-3, "m/s", 0.0, 0.1, "stall: a slower axis stands still"};
  rt::Property<double> stall_error{*this, "stall_error_m", 1e-3, "m", 0.0, 0.1, "stall: distance from the reference"};
  rt::Property<double> stall_time{*this, "stall_s", 0.3, "s", 0.001, 10.0, "stall: time that is a fault"};
  rt::Property<double> runaway_error{
      *this, "runaway_error_m", 1e-3, "m", 0.0, 0.1, "runaway: distance from the reference"};
  rt::Property<double> release_error{
      *this,
      "release_error_m",
      4e-3,
      "m",
      0.0,
      0.1,
      "runaway: distance while the Drivers take over the load from the holding brakes, instead of runaway_error_m"};
  rt::Property<double> release_time{*this, "release_s", 0.3, "s", 0.0, 2.0, "runaway: duration of that take-over"};
  rt::Property<double> runaway_speed{
      *this, "runaway_speed_m_per_s", 0.03, "m/s", 0.0, 1.0, "runaway: speed away from the reference"};
  rt::Property<double> runaway_time{
      *this, "runaway_s", 0.005, "s", 0.001, 1.0, "runaway: time without slowing down that is a fault"};
  rt::Property<double> runaway_acceleration{*this, "runaway_acceleration_m_per_s2",          0.5, "m/s^2", 0.0,
                                            20.0,  "runaway: mean acceleration in this time"};
  rt::Property<double> runaway_share{
      *this, "runaway_force_share", 0.1, "", 0.01, 1.0, "runaway: or growth of the force, without effect"};
  rt::Property<double> saturation_time{
      *this, "saturation_s", 0.25, "s", 0.001, 10.0, "saturation: time with the force at its clamp that is a fault"};
  rt::Property<double> thermal_time{*this,
                                    "thermal_time_constant_s",
                                    40.0,
                                    "s",
                                    1.0,
                                    2000.0,
                                    "time constant of the winding's temperature above the housing's; an RE40's"};
  rt::Property<double> thermal_housing{
      *this,
      "thermal_housing_s",
      1100.0,
      "s",
      1.0,
      20000.0,
      "time constant of the housing's temperature above the room's; an RE40's in free air"};
  rt::Property<double> thermal_share{
      *this, "thermal_winding_share", 0.29, "", 0.0, 1.0, "share of the rise between winding and housing"};
  rt::Property<double> thermal_start{
      *this, "thermal_start", 0.0, "", 0.0, 1.0, "lowest heat at the controller's start, share of the limit"};
  rt::Property<double> patient_margin_m{*this, "patient_margin_m", 0.002, "m", 0.0, 0.02, "patient pose: tolerance"};
  rt::Property<double> patient_margin_rad{*this, "patient_margin_rad",     0.01, "rad", 0.0,
                                          0.1,   "patient pose: tolerance"};
  rt::Property<double> patient_speed_factor{
      *this, "patient_speed_factor", 1.3, "", 1.0, 3.0, "patient speed: limit, times the patient's speeds"};

  rt::Property<double> patient_force_time{*this, "patient_force_s", 0.05, "s", 0.0, 1.0, "patient force: duration"};

  void setPatient(const PatientRange& range);
  rt::Operation<void(const PatientRange&)> set_patient{
      *this,
      "setPatient",
      {"range"},
      "limits that hold from the next cycle on; while the drives are off",
      [this](const PatientRange& range) { setPatient(range); }};
  rt::Operation<void(const AxisValues&)> start_heat{
      *this,
      "startHeat",
      {"heat"},
      "of the motors, 0 to 1, when it is known from before; thermal_start is the least; before start()",
      [this](const AxisValues& heat) { known_heat_ = heat; }};

 protected:
  bool startHook() override;
  void updateHook(const rt::Cycle& cycle) override;

 private:
  struct Axis {
    EncoderJumpMonitor jump;
    EncoderLeapMonitor leap;
    EncoderNoiseMonitor noise;
    EncoderFrozenMonitor frozen;
    SoftLimitMonitor soft;
    VelocityMonitor velocity;
    AccelerationMonitor acceleration;
    StallMonitor stall;
    RunawayMonitor runaway;
    SaturationMonitor saturation;
    ThermalMonitor thermal;
    WeightMonitor weight;
    double force_limit_N = 0.0;
    std::int64_t last_counts = 0;

    /// What is seen while the Drivers carry begins anew. Jumps and soft limits remember nothing; heat and
    /// an encoder's noise stay.
    void reset() noexcept {
      frozen.reset();
      velocity.reset();
      acceleration.reset();
      stall.reset();
      runaway.reset();
      saturation.reset();
      weight.reset();
    }
  };

  void readPorts();
  void monitorAxes(double dt) noexcept;
  AxisView viewOf(std::size_t axis, double dt) noexcept;
  Fault evaluate(std::size_t axis, const AxisView& view) noexcept;
  /// The force still grows to what the axes carry: the platform sags, by a few mm at most (release_error).
  bool takingOver() const noexcept { return carried_s_ < release_time; }
  Fault monitorPatient(double dt) noexcept;
  Fault monitorForce(double dt) noexcept;
  void raise(std::size_t axis, Fault fault) noexcept;
  void forget() noexcept;

  const mechanism::Robot robot_;
  const std::array<rt::InputPort<AxisCommand>*, hardware::kAxes> inputs_;
  std::array<Axis, hardware::kAxes> axes_;
  AxisValues known_heat_{};
  PatientMonitor patient_monitor_;
  std::mutex offering_;
  rt::DataChannel<PatientRange> offered_;
  PatientRange patient_;
  Disturbance disturbed_;
  TrueFor too_strong_, unjudged_;  // the force on the patient
  AxesMeasurement measured_;
  std::array<AxisCommand, hardware::kAxes> commands_{};
  AxesWritten written_;
  bool any_ = false;
  bool gap_ = false;  // since the last reading
  bool carried_ = false;
  double carried_s_ = 0.0;  // since the holding brakes were released
  rt::Nanoseconds last_read_ = 0;
  MonitorVerdict out_;
};

}  // namespace knee_robot::control
