#pragma once

#include "knee_robot/control/axis_data.h"
#include "knee_robot/hardware/axis_bus.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"

namespace knee_robot::control {

/// First in the servo cycle: latches the counters, unwraps them and turns them into lengths.
///
///     position = length at start + encoder_sign * lead / counts_per_revolution * counts since the counters' reset
///
/// The length at start is what the program assumes until homing shifts it: incremental encoders know nothing better.
/// The velocity is a low-passed difference. A failed read repeats the last good values with the status of the failure.
class AxesInput : public rt::TaskContext {
 public:
  AxesInput(const std::string& name, const mechanism::Robot& robot, hardware::AxisBus& bus,
            const AxisValues& lengths_at_start);

  rt::InputPort<HomeSetting> home{*this, "home", "from the Supervisor", rt::Need::Optional};
  rt::OutputPort<AxesMeasurement> measurement{*this, "measurement", "position, velocity and digital inputs"};
  rt::Property<double> velocity_cutoff{*this,  "velocity_cutoff_hz",      60.0, "Hz", 1.0,
                                       1000.0, "low-pass of the velocity"};

 protected:
  bool startHook() override;
  void updateHook(const rt::Cycle& cycle) override;

 private:
  void convert(const hardware::AxisFeedback& feedback, double dt);

  hardware::AxisBus& bus_;
  AxisValues lengths_at_start_;
  std::uint32_t home_number_ = 0;
  AxisValues metres_per_count_{};  // signed
  AxesMeasurement out_;
  std::array<std::int32_t, hardware::kAxes> last_counts_{};
  rt::Nanoseconds last_good_ = 0;
  bool any_ = false;
};

}  // namespace knee_robot::control
