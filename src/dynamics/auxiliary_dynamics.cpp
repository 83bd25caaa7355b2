#include "knee_robot/dynamics/auxiliary_dynamics.h"

namespace knee_robot::dynamics {
namespace {

/// Rigid links, rotors and viscous friction of the parameters along one motion; weight included.
bool smoothForces(const PartedModel& model, const mechanism::Pose& pose, const mechanism::Vector4& velocity,
                  const mechanism::Vector4& acceleration, AuxiliaryData& data, mechanism::Vector4& forces) noexcept {
  mechanism::Motion motion;
  motion.pose = pose;
  if (!mechanism::poseRates(*model.mechanism, pose, velocity, acceleration, motion.pose_velocity,
                            motion.pose_acceleration) ||
      !extendedRegressor(*model.mechanism, model.gravity, motion, data.regressor, data.row)) {
    return false;
  }
  const ExtendedRegressor& row = data.row;
  const ExtendedParameters& p = model.parameters;
  forces.noalias() = row.leftCols<kInertialParameters>() * p.head<kInertialParameters>();
  for (int k = extended::kPassiveFriction; k < extended::kViscous; k += 2)  // viscous and Coulomb take turns
    forces += row.col(k) * p[k];
  forces.noalias() +=
      row.middleCols<mechanism::kLegs>(extended::kViscous) * p.segment<mechanism::kLegs>(extended::kViscous);
  forces.noalias() +=
      row.middleCols<mechanism::kLegs>(extended::kRotor) * p.segment<mechanism::kLegs>(extended::kRotor);
  return true;
}

}  // namespace

bool auxiliaryForces(const PartedModel& model, const mechanism::Pose& pose, const AuxiliaryMotion& motion,
                     AuxiliaryData& data, mechanism::Vector4& forces) noexcept {
  if (!model.mechanism) {
    forces = model.axis_parameters.row(2).transpose().cwiseProduct(motion.acceleration) +
             model.axis_parameters.row(0).transpose().cwiseProduct(motion.reference);
    return true;
  }
  const mechanism::Vector4 mean = 0.5 * (motion.velocity + motion.reference),
                           half_difference = 0.5 * (motion.velocity - motion.reference);
  mechanism::Vector4 sum, less;
  if (!smoothForces(model, pose, mean, motion.acceleration, data, sum) ||
      !smoothForces(model, pose, half_difference, mechanism::Vector4::Zero(), data, less)) {
    return false;
  }
  forces = sum - less;
  return true;
}

}  // namespace knee_robot::dynamics
