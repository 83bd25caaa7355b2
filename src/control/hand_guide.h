#pragma once

#include <array>
#include <memory>
#include <string>

#include "guided_path.h"
#include "knee_robot/control/axis_data.h"
#include "knee_robot/mechanism/pose_follower.h"
#include "knee_robot/rt/channel.h"
#include "knee_robot/rt/operation.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"
#include "residual_estimator.h"
#include "virtual_walls.h"

namespace knee_robot::control {

/// Lets a hand move the platform (SupervisorCommand::guiding), and remembers the path. ModelFeedforward carries the
/// weight; this adds, per axis,
///
///     force = share_friction * (viscous * v + Coulomb * tanh(v / kSlow))   identified friction along the motion
///           + tremble * (1 - |tanh(v / kSlow)|)                               where an axis stands
///           - damping * v - brake(speed) * v                                  soft, and hard near the speed limit
///           + walls(pose)                                                     VirtualWalls
///
/// - Friction that stands has no direction. So a standing axis trembles: share_friction of its Coulomb friction, to and
///   fro at 25 Hz, less than what makes it slip by itself; a hand then needs only the rest of it. share_friction stays
///   below 1: friction is never made negative, as long as it is not smaller than share_friction of what was identified.
///   What DisturbanceObserver has found it to be less by, along paths played before, is not compensated.
/// - For weigh_s after the begin the Drivers' loops stay closed while the axes tremble: sticking friction lets go, and
///   the integrals become what the model does not know of the load. An undeclared load cannot be told from a hand that
///   leans on the platform. So half of the unexplained force is compensated, and friction only so far that what remains
///   holds the other half. More than that, or than unknown_load_N, in an axis ends the guiding, also when a feedforward
///   that is switched makes it so.
/// - Speed: from 80 % of linear_m_per_s and angular_rad_per_s on (the patient's, where that is less) it brakes; 1.5
///   times for 0.1 s, or 3 times for 0.01 s, ends it.
/// - A wall's depth of 90 % ends it (begun near there: 93 %). What ends it leads to holding where the platform is (SS2
///   by the Drivers' own loops): the command is `stop`, the Supervisor gives the order. So do a lost pose and a path
///   that is full.
/// - An encoder that stands while another leg has moved by kMoves_m is asked by its Driver (EncoderChallenge), as
///   nothing else would notice. So is one after the other, every kAllStand_s, while all stand: without their common
///   supply none counts, and the hand would meet no wall.
/// Needs an identified model; without one `stop` is NoModel from the start. Runs between AxesInput and the Drivers;
/// real-time safe.
class HandGuide : public rt::TaskContext {
 public:
  static constexpr double kSlow_m_per_s = 2e-3, kCutoff_hz = 20.0, kTremble_s = 0.04, kMoves_m = 2e-3,
                          kAllStand_s = 1.0;

  HandGuide(const std::string& name, const mechanism::Robot& robot);

  rt::InputPort<AxesMeasurement> measurement{*this, "measurement", "from AxesInput"};
  rt::InputPort<SupervisorCommand> orders{*this, "orders", "from the Supervisor"};
  rt::InputPort<AxisCommand> command_1{*this, "command_1", "from the Driver of axis 1"};
  rt::InputPort<AxisCommand> command_2{*this, "command_2", "from the Driver of axis 2"};
  rt::InputPort<AxisCommand> command_3{*this, "command_3", "from the Driver of axis 3"};
  rt::InputPort<AxisCommand> command_4{*this, "command_4", "from the Driver of axis 4"};
  rt::InputPort<Disturbance> disturbance{*this, "disturbance",
                                         "friction that has become less, from DisturbanceObserver", rt::Need::Optional};
  rt::OutputPort<Guidance> guidance{*this, "guidance", "to the Drivers and the Supervisor"};

  rt::Property<std::string> model{*this, "model", "", "model file of this robot; empty: nothing is guided"};
  rt::Property<double> share_friction{
      *this, "share_friction", 0.7, "", 0.0, 0.9, "share that is compensated", rt::Change::AtRunTime};
  rt::Property<double> damping{*this, "damping_N_s_per_m", 60.0, "N s/m", 0.0, 5000.0, "damping of each axis"};
  rt::Property<double> linear_speed{*this,
                                    "linear_m_per_s",
                                    0.05,
                                    "m/s",
                                    0.001,
                                    0.2,
                                    "speed limit of the platform's origin; the patient's limit, if that is lower"};
  rt::Property<double> angular_speed{
      *this, "angular_rad_per_s", 0.2, "rad/s", 0.001, 1.0, "speed limit of theta and psi, likewise"};
  rt::Property<double> wall_force{
      *this, "wall_N", 80.0, "N", 0.0, 500.0, "largest force of a virtual wall, at its limit"};
  rt::Property<double> unknown_load{
      *this, "unknown_load_N", 120.0, "N", 0.0, 1000.0, "largest force per axis that the model does not explain"};
  rt::Property<double> weigh_time{
      *this, "weigh_s", 0.6, "s", 0.1, 5.0, "time in which the unexplained force is measured"};

  rt::Operation<GuidedPath&()> path{
      *this, "path", {}, "along which the platform was guided last", [this]() -> GuidedPath& { return path_; }};

  /// Limits of a patient, from the next cycle on. Any thread, one at a time.
  void setPatient(PatientRange range) { offered_.write(range); }
  /// Ordinary thread, before configure(): reads the model. InputError names the file and the reason. configure() does
  /// it otherwise.
  void loadModel();

 protected:
  bool configureHook() override;
  bool startHook() override;
  void updateHook(const rt::Cycle& cycle) override;

 private:
  void readPorts(double dt) noexcept;
  bool findMotion() noexcept;
  void guide(double dt) noexcept;
  void standBy() noexcept;
  GuideStop whyNot() const noexcept;
  AxisValues frictionForce() const noexcept;
  void weigh(double dt, const AxisValues& given) noexcept;
  double frictionShare(std::size_t axis) const noexcept;
  double frictionLeft(std::size_t axis) const noexcept;
  double coulomb(std::size_t axis) const noexcept;
  double largestUnknown(std::size_t axis) const noexcept;
  double speedShare() const noexcept;
  void give(const AxisValues& force_N) noexcept;
  void doubt(double dt) noexcept;
  void remember(double dt) noexcept;

  const mechanism::Robot robot_;
  const std::array<rt::InputPort<AxisCommand>*, hardware::kAxes> inputs_;
  std::unique_ptr<const ForceKnowledge> knowledge_;
  VirtualWalls walls_;
  GuidedPath path_;
  rt::DataChannel<PatientRange> offered_;
  PatientRange patient_;
  AxesMeasurement measured_;
  SupervisorCommand order_;
  Disturbance disturbed_;
  std::array<AxisCommand, hardware::kAxes> commands_{};
  int silent_ = 0;      // cycles without orders
  bool known_ = false;  // pose and motion are
  mechanism::PoseFollower pose_;
  mechanism::Vector4 velocity_ = mechanism::Vector4::Zero(), pose_velocity_ = mechanism::Vector4::Zero();
  VirtualWalls::Push push_;
  AxisValues stood_m_{};   // where each axis was when its encoder moved last
  AxisValues others_m_{};  // way of the others since then
  double all_stand_s_ = 0.0;
  std::size_t asked_ = 0;   // axis that was asked last because all stood
  AxisValues unknown_N_{};  // in the integrals
  AxisValues last_m_{};
  double began_ = 0.0;  // depth of the walls where the guiding began
  double guided_s_ = 0.0, fast_s_ = 0.0, runs_s_ = 0.0, sampled_s_ = 0.0;
  rt::Nanoseconds last_time_ = 0;
  Guidance out_;
};

}  // namespace knee_robot::control
