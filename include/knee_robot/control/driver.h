#pragma once

#include <atomic>
#include <string>

#include "knee_robot/control/axis_data.h"
#include "knee_robot/control/encoder_watch.h"
#include "knee_robot/control/hardware_file.h"
#include "knee_robot/control/homing_move.h"
#include "knee_robot/control/pid.h"
#include "knee_robot/control/set_point_follower.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"

namespace knee_robot::control {

/// Position control of one axis, once its period (default 1 ms).
///
///     reference = SetPointFollower(set points)          interpolation between two 10 ms points
///     force     = Pid(reference, measured) + feedforward   N; gains in N/m fit every motor and screw
///     volts     = force_sign * force / force_per_volt      clamped to voltage_max and force_max
///
/// When a feedforward share changes, or the feedforward starts, stops or goes silent, the integral takes up the
/// difference: the force does not step.
/// With a ControlLaw the model's feedback is added; where it takes the place of P and D, and where it ceases, the
/// integral takes up that, too.
/// Gains may change while the loop is closed: the integral takes up the difference, so the force does not jump.
/// Takes over (SupervisorCommand::drivers_active) at the measured position with the integral at zero: no force but the
/// feedforward's. Faults are kept until the Drivers are switched off again. While SupervisorCommand::homing has its
/// bit, HomingMove gives reference and force limit instead.
/// While a hand guides (SupervisorCommand::guiding) HandGuide's force takes the place of the loop, and the integral
/// keeps what it carries; reference is where the axis is. When that ends, or HandGuide falls silent, the axis holds
/// where it is then.
/// Encoder test (faults EncoderFrozen, AxisBlocked): EncoderWatch.
/// - SetPointStale: nothing from Sync for stale_set_points periods, or a set point is missing. The loop goes on (the
///   reference comes to rest).
/// - NotANumber, FollowingError, SetPointJump, MeasurementLost: the loop is given up (active = false, 0 V asked for);
///   what the axis gets from then on is AxesOutput's safe stop.
class Driver : public rt::TaskContext {
 public:
  Driver(const std::string& name, const mechanism::Robot& robot, const HardwareFile& hardware = {});

  rt::InputPort<SupervisorCommand> orders{*this, "orders", "from the Supervisor"};
  rt::InputPort<AxesMeasurement> measurement{*this, "measurement", "from AxesInput"};
  rt::InputPort<SetPoint> set_point{*this, "set_point", "from Sync"};
  rt::InputPort<FeedforwardForce> feedforward{*this, "feedforward", "load of the axes, from ModelFeedforward",
                                              rt::Need::Optional};
  rt::InputPort<Disturbance> disturbance{*this, "disturbance", "from the DisturbanceObserver", rt::Need::Optional};
  rt::InputPort<MonitorVerdict> verdict{*this, "verdict",
                                        "from the Monitors, of the last cycle: whether they want the encoder asked",
                                        rt::Need::Optional};
  rt::InputPort<Guidance> guidance{*this, "guidance", "from HandGuide", rt::Need::Optional};
  rt::OutputPort<AxisCommand> command{*this, "command", "to AxesOutput"};

  rt::Property<int> axis{*this, "axis", 1, "", 1, hardware::kAxes, "actuator that is driven"};
  rt::Property<double> proportional{*this, "proportional_N_per_m", 40000.0, "N/m", 0.0, 1e6,
                                    "P",   rt::Change::AtRunTime};
  rt::Property<double> integral{*this, "integral_N_per_m_s", 200000.0, "N/(m s)", 0.0, 1e7, "I", rt::Change::AtRunTime};
  rt::Property<double> derivative{*this, "derivative_N_s_per_m", 1200.0, "N s/m", 0.0, 1e5, "D", rt::Change::AtRunTime};
  rt::Property<double> derivative_cutoff{
      *this, "derivative_cutoff_hz", 80.0, "Hz", 1.0, 1000.0, "low-pass of the velocity", rt::Change::AtRunTime};
  rt::Property<double> following_floor{
      *this, "following_error_m", 0.008, "m", 1e-4, 0.1, "largest distance from the reference at rest"};
  rt::Property<double> following_slope{
      *this, "following_error_s", 0.1, "s", 0.0, 1.0, "added to it per m/s of reference velocity"};
  rt::Property<int> stale_set_points{
      *this, "stale_set_points", 3, "periods", 2, 100, "time without set points that is a fault"};
  rt::Property<int> missing_set_points{
      *this, "missing_set_points", 0, "set points", 0, 100, "set points in a row that may be missing without a fault"};
  rt::Property<double> probe_period{
      *this,
      "probe_s",
      0.6,
      "s",
      0.0,
      60.0,
      "without a DisturbanceObserver: time between two tests whether the encoder of a standing axis counts; 0: never"};
  rt::Property<double> probe_share{
      *this, "probe_share", 0.5, "", 0.05, 1.0, "largest test pulse, share of the force limit"};
  rt::Property<double> standing_force{
      *this,
      "standing_force_N",
      5.0,
      "N",
      0.1,
      1000.0,
      "with a DisturbanceObserver: change of the loop's force without a count that starts a test pulse, at rest"};
  rt::Property<double> turning_force{
      *this, "turning_force_N", 15.0, "N", 0.1, 1000.0, "the same while the reference moves"};
  rt::Property<int> stale_measurements{
      *this, "stale_measurements", 3, "cycles", 1, 100, "unreadable measurements in a row that are a fault"};

  /// Whether test pulses are allowed (yes, until told otherwise) where nothing raises a suspicion. Any thread.
  void allowTestPulses(bool allowed) noexcept { test_pulses_.store(allowed, std::memory_order_relaxed); }

 protected:
  bool configureHook() override;
  bool startHook() override;
  void updateHook(const rt::Cycle& cycle) override;

 private:
  void readPorts(const rt::Cycle& cycle);
  void takeOver(const rt::Cycle& cycle);
  void control(const rt::Cycle& cycle);
  void readFeedforward(const rt::Cycle& cycle) noexcept;
  void changeLoop(const PidInput& input) noexcept;
  double loopForce() const noexcept;
  void readGuidance(const rt::Cycle& cycle) noexcept;
  double loop(const SetPointFollower::Reference& reference, double dt) noexcept;
  void checkReference(const rt::Cycle& cycle, bool searching);
  double watchEncoder(double dt) noexcept;
  SetPointFollower::Reference chooseReference(const rt::Cycle& cycle, double dt) noexcept;
  bool isToHome() const noexcept { return (order_.homing >> index_ & 1) != 0; }
  void raise(Fault fault) noexcept;
  PidGains gains() const noexcept;

  const mechanism::Robot robot_;
  mechanism::Actuator actuator_;
  std::size_t index_ = 0;
  SetPointFollower follower_{0, 0.0, 0.0, 0.0};
  const HardwareFile hardware_;
  HomingMove homing_;
  EncoderWatch encoder_;
  Disturbance disturbed_;
  MonitorVerdict verdict_;
  std::atomic<bool> test_pulses_{true};
  Pid pid_;
  double force_limit_ = 0.0;  // N
  double force_now_ = 0.0;    // N, limit of this cycle
  double shifted_N_ = 0.0;    // of the loop's force, into the feedforward
  double carried_N_ = 0.0;    // what the axis carried at rest when its homing began: the low force comes on top of it
  SupervisorCommand order_;
  AxesMeasurement measured_;
  int unreadable_ = 0;
  FeedforwardForce model_force_;
  double load_ = 0.0;  // N, of the feedforward
  double loop_ = 0.0;  // N, of the model's feedback
  double last_loop_ = 0.0;
  bool model_closes_ = false, model_closed_ = false;  // that feedback takes the place of P and D; in the last cycle
  double switched_ = 0.0;                             // N, as last seen
  double declared_ = 0.0;                             // N, likewise
  bool feedforward_alive_ = false;                    // the feedforward is alive
  Guidance guide_;
  double guided_N_ = 0.0;
  bool guides_ = false, guided_ = false;  // HandGuide's force takes the place of the loop; it did in the last cycle
  bool doubted_ = false;                  // it asks for the encoder
  bool held_here_ = false;                // SupervisorCommand::holds_here of the last cycle
  bool active_ = false;
  Fault fault_ = Fault::None;
  rt::Nanoseconds last_time_ = 0;
  AxisCommand out_;
};

}  // namespace knee_robot::control
