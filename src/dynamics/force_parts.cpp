#include "knee_robot/dynamics/force_parts.h"

#include "force_model.h"

namespace knee_robot::dynamics {
namespace {

/// A passive joint turns about as fast as its leg lengthens, divided by the leg's length.
constexpr double kTypicalLength_m = 0.7;
constexpr int kPlatformMass = kPlatformLink * kLinkParameters + kLinkParameters - 1;

template <int Count>
knee_robot::mechanism::Vector4 block(const knee_robot::dynamics::ExtendedRegressor& row,
                                     const knee_robot::dynamics::ExtendedParameters& parameters, int first) noexcept {
  return row.middleCols<Count>(first) * parameters.segment<Count>(first);
}

void axisParts(int axes, const mechanism::Matrix4& parameters, const WantedInstant& at, ForceParts& parts) noexcept {
  parts = ForceParts{};
  for (int i = 0; i < axes; ++i) {
    const mechanism::Vector4 terms =
        actuatorRegressor(at.velocity_m_per_s[i], at.acceleration_m_per_s2[i], at.coulomb_m_per_s)
            .cwiseProduct(parameters.col(i));
    parts.friction[i] = terms[0] + terms[1];
    parts.inertia[i] = terms[2];
    parts.gravity[i] = terms[3];
  }
}

}  // namespace

PartedModel::PartedModel(const mechanism::Robot& robot, const std::optional<RobotInertia>& inertia)
    : mechanism(robot.mechanism), gravity(robot.gravity), axes(robot.axes()), knows_motion(false) {
  parameters.setZero();
  axis_parameters.setZero();
  if (mechanism && inertia) parameters.head<kInertialParameters>() = toParameters(*inertia);
}

PartedModel::PartedModel(const Model& model, const mechanism::Robot& robot) : PartedModel(robot, std::nullopt) {
  identified.emplace(model, robot);
  const ForceModel& whole = *identified;
  parameters = whole.parameters;
  axis_parameters = whole.axis_parameters;
  parameters.segment<mechanism::kLegs>(extended::kCoulomb) = whole.coulomb;
  axis_parameters.row(1) = whole.coulomb.transpose();
  knows_motion = true;
}

bool smoothParts(const PartedModel& model, const ExtendedParameters& parameters,
                 const mechanism::Matrix4& axis_parameters, const WantedInstant& at, mechanism::Motion& motion,
                 ForcePartsData& data, ForceParts& parts) noexcept {
  if (!model.mechanism) {
    axisParts(model.axes, axis_parameters, at, parts);
    return true;
  }
  if (!extendedRegressor(*model.mechanism, model.gravity, motion, data.regressor, data.still)) return false;
  const mechanism::Vector4 weight = block<kInertialParameters>(data.still, parameters, 0);
  parts.gravity = weight + block<mechanism::kLegs>(data.still, parameters, extended::kOffset);
  parts.payload_gravity = data.still.col(kPlatformMass);
  data.moves = model.knows_motion && !(at.velocity_m_per_s.isZero(0.0) && at.acceleration_m_per_s2.isZero(0.0));
  if (!data.moves) return true;
  const CoulombWidth width{at.coulomb_m_per_s, at.coulomb_m_per_s / kTypicalLength_m};
  if (!mechanism::poseRates(*model.mechanism, motion.pose, at.velocity_m_per_s, at.acceleration_m_per_s2,
                            motion.pose_velocity, motion.pose_acceleration) ||
      !extendedRegressor(*model.mechanism, model.gravity, motion, data.regressor, data.moving, width)) {
    return false;
  }
  parts.friction = block<extended::kPassiveFrictionCount>(data.moving, parameters, extended::kPassiveFriction) +
                   block<2 * mechanism::kLegs>(data.moving, parameters, extended::kViscous);
  parts.inertia = block<kInertialParameters>(data.moving, parameters, 0) - weight +
                  block<mechanism::kLegs>(data.moving, parameters, extended::kRotor);
  parts.payload_inertia = data.moving.col(kPlatformMass) - data.still.col(kPlatformMass);
  return true;
}

bool forceParts(const PartedModel& model, const mechanism::Pose& pose, const mechanism::Vector4& velocity,
                const mechanism::Vector4& acceleration, double coulomb_m_per_s, ForcePartsData& data,
                ForceParts& parts) noexcept {
  WantedInstant at;
  at.velocity_m_per_s = velocity;
  at.acceleration_m_per_s2 = acceleration;
  at.coulomb_m_per_s = coulomb_m_per_s;
  mechanism::Motion motion;
  motion.pose = pose;
  ForceParts found;
  if (!smoothParts(model, model.parameters, model.axis_parameters, at, motion, data, found)) return false;
  parts = found;
  return true;
}

}  // namespace knee_robot::dynamics
