#pragma once

#include <optional>

#include "knee_robot/dynamics/model.h"
#include "knee_robot/dynamics/robot_inertia.h"

namespace knee_robot::dynamics {

/// A force model that can be taken apart, for a feedforward that weighs its parts. Constant after construction.
struct PartedModel {
  /// Nothing but the weight of the links; no inertia, no friction. Without a mechanism (bench axes) it knows nothing at
  /// all.
  PartedModel(const mechanism::Robot& robot, const std::optional<RobotInertia>& inertia);
  /// Everything that was identified. InputError as ForceModel.
  PartedModel(const Model& model, const mechanism::Robot& robot);

  std::optional<mechanism::Mechanism> mechanism;  ///< empty for bench axes
  mechanism::Vector3 gravity;                     ///< m/s^2, base frame
  int axes;
  ExtendedParameters parameters;         ///< of the parallel robot, Coulomb friction included
  mechanism::Matrix4 axis_parameters;    ///< of bench axes: column i holds viscous, Coulomb, rotor, offset of axis i
  bool knows_motion;                     ///< there is more than gravity
  std::optional<ForceModel> identified;  ///< with the laws of friction and the effects; empty without a model file
};

/// Actuator forces (N) that a motion needs, by cause.
struct ForceParts {
  mechanism::Vector4 gravity = mechanism::Vector4::Zero();  ///< weight and constant offsets
  mechanism::Vector4 inertia = mechanism::Vector4::Zero();  ///< rigid links and rotors
  mechanism::Vector4 friction =
      mechanism::Vector4::Zero();  ///< viscous and Coulomb, of actuators and passive joints; zero at rest
  mechanism::Vector4 payload_gravity =
      mechanism::Vector4::Zero();  ///< N per kg of a point mass at the platform's origin
  mechanism::Vector4 payload_inertia = mechanism::Vector4::Zero();

  bool allFinite() const noexcept {
    return gravity.allFinite() && inertia.allFinite() && friction.allFinite() && payload_gravity.allFinite() &&
           payload_inertia.allFinite();
  }
};

/// Workspace of forceParts, and what remembers: make one and keep it.
struct ForcePartsData {
  RegressorData regressor, later;
  ExtendedRegressor still, moving;
  bool moves = true;  ///< `moving` is filled
  MotionMemory memory;
};

/// The parts at `pose` with these velocities (m/s) and accelerations (m/s^2) of the actuators. Coulomb friction is
/// tanh(velocity / coulomb_m_per_s): zero at rest, without a step. The sum without payload is forceFromModel's, but for
/// friction near rest. False, with `parts` untouched, where the mechanism is singular. Real-time safe.
bool forceParts(const PartedModel& model, const mechanism::Pose& pose, const mechanism::Vector4& velocity,
                const mechanism::Vector4& acceleration, double coulomb_m_per_s, ForcePartsData& data,
                ForceParts& parts) noexcept;

/// One instant of the motion that is wanted; per actuator.
struct WantedInstant {
  double period_s = 0.001;                                     ///< since the instant before, positive
  mechanism::Vector4 position_m = mechanism::Vector4::Zero();  ///< measured
  mechanism::Vector4 velocity_m_per_s = mechanism::Vector4::Zero(), acceleration_m_per_s2 = mechanism::Vector4::Zero();
  double coulomb_m_per_s = 2e-4;  ///< of tanh, for friction that has no law of its own (passive joints, no model file)
  double rest_s = 0.0;            ///< time in which a wanted rest lets go of friction that is held; 0: never
};

/// The same with everything that the model file has: friction by its law near rest, and effects, each in the part it
/// belongs to (what is ahead in `inertia`). Call it once per instant, in order of time: they remember. Without a model
/// file it is the above. Real-time safe.
bool forceParts(const PartedModel& model, const mechanism::Pose& pose, const WantedInstant& at, ForcePartsData& data,
                ForceParts& parts) noexcept;
/// The drives were off for so long, s: friction starts anew, what was warm cools. Real-time safe.
void restParts(const PartedModel& model, double duration_s, ForcePartsData& data) noexcept;

}  // namespace knee_robot::dynamics
