#pragma once

#include <optional>

#include "knee_robot/dynamics/model.h"
#include "knee_robot/dynamics/robot_inertia.h"

namespace knee_robot::dynamics {

/// A force model that can be taken apart, for a feedforward that weighs its parts. Constant after construction.
struct PartedModel {
  /// Nothing but the weight of the links; no inertia, no friction. Without a mechanism (bench axes) it knows nothing at all.
  PartedModel(const mechanism::Robot& robot, const std::optional<RobotInertia>& inertia);
  /// Everything that was identified. InputError as ForceModel.
  PartedModel(const Model& model, const mechanism::Robot& robot);

  std::optional<mechanism::Mechanism> mechanism;  ///< empty for bench axes
  mechanism::Vector3 gravity;                     ///< m/s^2, base frame
  int axes;
  ExtendedParameters parameters;       ///< of the parallel robot, Coulomb friction included
  mechanism::Matrix4 axis_parameters;  ///< of bench axes: column i holds viscous, Coulomb, rotor, offset of axis i
  bool knows_motion;                   ///< there is more than gravity
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

/// Workspace of forceParts: make one and keep it.
struct ForcePartsData {
  RegressorData regressor;
  ExtendedRegressor still, moving;
};

/// The parts at `pose` with these velocities (m/s) and accelerations (m/s^2) of the actuators. Coulomb friction is
/// tanh(velocity / coulomb_m_per_s): zero at rest, without a step. The sum without payload is forceFromModel's, but for
/// friction near rest. False, with `parts` untouched, where the mechanism is singular. Real-time safe.
bool forceParts(const PartedModel& model, const mechanism::Pose& pose, const mechanism::Vector4& velocity,
                const mechanism::Vector4& acceleration, double coulomb_m_per_s, ForcePartsData& data,
                ForceParts& parts) noexcept;

}  // namespace knee_robot::dynamics
