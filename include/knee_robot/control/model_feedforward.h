#pragma once

#include <array>
#include <memory>
#include <string>

#include "knee_robot/control/axis_data.h"
#include "knee_robot/control/control_law.h"
#include "knee_robot/dynamics/force_parts.h"
#include "knee_robot/mechanism/pose_follower.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"

namespace knee_robot::control {

/// The load of the four axes by a model, once a servo cycle, which the Drivers add to their forces: weight at the
/// measured pose, inertia and friction along the reference. What the model does not know is left to the Drivers'
/// integrals.
///
///     force = level * (share_gravity * (weight + payload_kg * w) + share_inertia * (inertia + ...)
///                      + share_friction * friction)
///
/// - Model: by default the weights of the robot's URDF (nothing without URDF), otherwise everything in the file of
///   `model`.
/// - Taking over (SupervisorCommand::drivers_active): `level` rises from 0 to 1 in take_over_s while the holding brakes
///   are engaged; the Supervisor releases them only when `complete`, onto a force that already carries the robot.
/// - A share or the payload that changes moves there in switch_s. That is no change of the load: `switched_N` counts
///   the newtons that were switched, the Drivers' integrals take up the difference, and the force on the motors stays.
/// - Friction goes by the reference's motion, never by the measured one: by the law near rest that was identified,
///   which builds up over a way and is held at a turning point. Where the reference rests it is let go of in rest_s: it
///   can not make an axis move that should stand.
/// - Effects of `trace` act in the part they belong to: springs, offsets, ripples with the weight; friction's with
///   friction; a delay or drive lag with the inertia, as the force of that much later on the reference as it goes on.
///   source() names those that are left out.
/// - Every axis stays within largest_share of its force limit.
/// - Pose unknown (forward kinematics without result, near a singularity), or a part that is no number: 0 N from this
///   cycle on, taken up by the integrals like a share; when the pose is known again the force comes back in switch_s.
///   Unreadable encoders: the last pose.
/// - Homing: 0 N from its begin until the Drivers are switched off; not homed, lengths mean nothing.
/// - law: besides feedforward, feedback through the identified model (ControlLaw says which, and why it is stable):
///   loop_N, outside of shares and levels, zero wherever the forces are. Monitors, faults and the safe stop do not know
///   of it; a model that falls silent leaves the Drivers with their own loops.
/// Runs between AxesInput and the Drivers. The Drivers' reference is that of the last cycle. No allocation, no lock.
class ModelFeedforward : public rt::TaskContext {
 public:
  static constexpr double kLargestPayload_kg = 50.0;

  ModelFeedforward(const std::string& name, const mechanism::Robot& robot);

  rt::InputPort<AxesMeasurement> measurement{*this, "measurement", "from AxesInput"};
  rt::InputPort<SupervisorCommand> orders{*this, "orders", "from the Supervisor"};
  rt::InputPort<AxisCommand> command_1{*this, "command_1", "from the Driver of axis 1"};
  rt::InputPort<AxisCommand> command_2{*this, "command_2", "from the Driver of axis 2"};
  rt::InputPort<AxisCommand> command_3{*this, "command_3", "from the Driver of axis 3"};
  rt::InputPort<AxisCommand> command_4{*this, "command_4", "from the Driver of axis 4"};
  rt::OutputPort<FeedforwardForce> feedforward{*this, "feedforward", "to the Drivers"};

  rt::Property<std::string> model{*this, "model", "", "model file of this robot; empty: the weights of its URDF"};
  rt::Property<double> share_gravity{
      *this, "share_gravity", 1.0, "", 0.0, 1.0, "share of the weight, offsets included", rt::Change::AtRunTime};
  rt::Property<double> share_inertia{
      *this, "share_inertia", 1.0, "", 0.0, 1.0, "share of the inertial forces", rt::Change::AtRunTime};
  rt::Property<double> share_friction{
      *this, "share_friction", 0.9, "", 0.0, 1.0, "share of the friction", rt::Change::AtRunTime};
  rt::Property<double> payload{*this,
                               "payload_kg",
                               0.0,
                               "kg",
                               0.0,
                               kLargestPayload_kg,
                               "point mass at the platform's origin, beyond what the model includes",
                               rt::Change::AtRunTime};
  rt::Property<double> largest_share{
      *this, "largest_share", 0.8, "", 0.0, 1.0, "largest feedforward, share of an axis' force limit"};
  rt::Property<double> coulomb_speed{*this,
                                     "coulomb_m_per_s",
                                     2e-4,
                                     "m/s",
                                     1e-5,
                                     0.1,
                                     "reference velocity at which friction without a law has 76 % of its size"};
  rt::Property<double> rest_time{
      *this, "rest_s", 0.3, "s", 0.01, 60.0, "time in which the friction force fades out at rest"};
  rt::Property<double> take_over_time{
      *this, "take_over_s", 0.03, "s", 0.0, 1.0, "time until the force is complete at take-over"};
  rt::Property<double> switch_time{
      *this, "switch_s", 0.5, "s", 0.0, 10.0, "time for a change of a share from 0 to 1, or of the payload by 50 kg"};

  rt::Property<std::string> law{*this, "law", "feedforward",
                                "feedforward, computed_torque or passivity_based; the last two need a model"};
  rt::Property<double> lambda{
      *this, "lambda_per_s", 20.0, "1/s", 0.1, 1000.0, "passivity_based: reference velocity per metre of error"};
  rt::Property<double> stiffness{
      *this, "stiffness_per_s2", 4000.0, "1/s^2", 0.0, 1e6, "computed_torque: acceleration per metre of error"};
  rt::Property<double> damping{
      *this, "damping_per_s", 125.0, "1/s", 0.0, 1e4, "computed_torque: acceleration per m/s of error"};
  rt::Property<double> velocity_cutoff{
      *this, "velocity_cutoff_hz", 100.0, "Hz", 1.0, 1000.0, "velocity low-pass of both laws"};

  /// Ordinary thread, before configure(): reads `law`. InputError names the property and what it needs.
  void readLaw();
  Law chosenLaw() const noexcept { return law_.law(); }
  /// Ordinary thread, before configure(): reads the model and the law. InputError names the file and the reason.
  /// configure() does it otherwise.
  void loadModel();
  /// Where the forces come from, for the operator. After loadModel().
  const std::string& source() const { return source_; }

 protected:
  bool configureHook() override;
  bool startHook() override;
  void updateHook(const rt::Cycle& cycle) override;

 private:
  /// What parts are multiplied with now; they follow the properties.
  struct Weights {
    double gravity = 0.0, inertia = 0.0, friction = 0.0, payload_kg = 0.0;
  };
  Weights asked() const noexcept;
  static Weights atRest(const Weights& w) noexcept { return {w.gravity, 0.0, 0.0, w.payload_kg}; }
  void readPorts() noexcept;
  void followReference(std::size_t axis) noexcept;
  void carry(double dt) noexcept;
  void letGo(double dt) noexcept;
  void drop() noexcept;
  void weigh(double before_kg) noexcept;
  void forgetWeight() noexcept;
  bool findParts() noexcept;
  AxisValues total(const Weights& weights, double level) const noexcept;
  void closeLoop(double dt) noexcept;
  void openLoop() noexcept;

  const mechanism::Robot robot_;
  const std::array<rt::InputPort<AxisCommand>*, hardware::kAxes> inputs_;
  std::unique_ptr<const dynamics::PartedModel> model_;
  std::string source_;
  std::array<double, hardware::kAxes> largest_N_{};
  ControlLaw law_;
  double since_law_s_ = 0.0;

  AxesMeasurement measured_;
  bool new_reading_ = false;
  SupervisorCommand order_;
  std::array<AxisCommand, hardware::kAxes> commands_{};
  mechanism::Vector4 velocity_ = mechanism::Vector4::Zero(),
                     acceleration_ = mechanism::Vector4::Zero();  // of the reference
  dynamics::ForcePartsData data_;
  dynamics::ForceParts parts_;
  mechanism::PoseFollower pose_;
  bool parts_known_ = false;
  bool on_ = false;
  bool homing_ = false;
  bool taking_over_ = false;
  bool weighs_ = false;  // weight_N is known
  double level_ = 0.0;
  Weights weights_;
  rt::Nanoseconds last_time_ = 0, parts_time_ = 0;
  FeedforwardForce out_;
};

}  // namespace knee_robot::control
