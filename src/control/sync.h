#pragma once

#include "knee_robot/control/axis_data.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/rt/operation.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"
#include "reference_store.h"

namespace knee_robot::control {

/// Streams the reference: one set point per period (10 ms), all four axes in one message, so they start and stop on one
/// tick.
///
/// Path time runs by time_scale * period each time the component is executed (not by the clock: after a pause of the
/// machine the reference goes on where it was). While playing, the scale is SupervisorCommand::speed (0 to 1), or 0
/// while paused; a stop brings it to zero for good. Every change of it is linear in time, full speed to rest in
/// stop_time_s or longer where half of an axis' acceleration limit demands it: the robot stays on its path and there is
/// no jump of velocity, whatever is asked for in whichever order.
/// Starts only at the first point: |measured - first| <= start_tolerance_m on every axis, else it refuses with the
/// distance; and not before the Drivers have carried for 0.4 s: standing tells what nobody declared (CarriedLoad), motion
/// hardly does.
/// While a hand guides the platform it stands by: the next path begins anew. Holds at the last point. Stops by itself
/// when the Supervisor's orders do not come any more.
class Sync : public rt::TaskContext {
 public:
  Sync(const std::string& name, const mechanism::Robot& robot);

  rt::InputPort<SupervisorCommand> orders{*this, "orders", "from the Supervisor"};
  rt::InputPort<AxesMeasurement> measurement{*this, "measurement", "from AxesInput"};
  rt::OutputPort<SetPoint> set_point{*this, "set_point", "to the Drivers"};

  rt::Property<double> start_tolerance_m{*this,
                                         "start_tolerance_m",
                                         0.002,
                                         "m",
                                         0.0,
                                         0.01,
                                         "largest distance from the first point at which playing may start"};
  rt::Property<double> stop_time_s{
      *this, "stop_time_s", 0.3, "s", 0.05, 2.0, "time from full speed to rest on the path"};
  rt::Property<double> orders_timeout_s{
      *this, "orders_timeout_s", 0.05, "s", 0.01, 1.0, "time without orders after which Sync stops the path by itself"};

  rt::Operation<ReferenceStore&()> store{
      *this, "store", {}, "where references are offered; taken over while not playing", [this]() -> ReferenceStore& {
        return store_;
      }};

 protected:
  bool startHook() override;
  void updateHook(const rt::Cycle& cycle) override;

 private:
  void standBy(const SupervisorCommand& orders);
  void tryToPlay(const SupervisorCommand& orders);
  void advance(const rt::Cycle& cycle, const SupervisorCommand& orders, bool stop);
  static double targetScale(const SupervisorCommand& orders) noexcept;
  double scaleRate() const noexcept;
  void restSegment(SyncPhase phase);

  const AxisValues acceleration_max_;
  ReferenceStore store_;
  const ReferencePath* path_ = nullptr;
  AxesMeasurement measured_;
  SetPoint out_;
  rt::Nanoseconds silent_ = 0;   // own cycles without new orders
  rt::Nanoseconds carried_ = 0;  // for so long the Drivers alone carry
  double path_time_ = 0.0;       // s
  double time_scale_ = 0.0;      // 0 to 1
  std::uint32_t handled_play_ = 0;
};

}  // namespace knee_robot::control
