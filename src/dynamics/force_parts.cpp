#include "knee_robot/dynamics/force_parts.h"

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

void axisParts(const PartedModel& model, const mechanism::Vector4& velocity, const mechanism::Vector4& acceleration,
               double coulomb_m_per_s, ForceParts& parts) noexcept {
  parts = ForceParts{};
  for (int i = 0; i < model.axes; ++i) {
    const mechanism::Vector4 terms =
        actuatorRegressor(velocity[i], acceleration[i], coulomb_m_per_s).cwiseProduct(model.axis_parameters.col(i));
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
  const ForceModel whole(model, robot);
  parameters = whole.parameters;
  axis_parameters = whole.axis_parameters;
  parameters.segment<mechanism::kLegs>(extended::kCoulomb) = whole.coulomb;
  axis_parameters.row(1) = whole.coulomb.transpose();
  knows_motion = true;
}

bool forceParts(const PartedModel& model, const mechanism::Pose& pose, const mechanism::Vector4& velocity,
                const mechanism::Vector4& acceleration, double coulomb_m_per_s, ForcePartsData& data,
                ForceParts& parts) noexcept {
  if (!model.mechanism) {
    axisParts(model, velocity, acceleration, coulomb_m_per_s, parts);
    return true;
  }
  mechanism::Motion motion;
  motion.pose = pose;
  if (!extendedRegressor(*model.mechanism, model.gravity, motion, data.regressor, data.still)) return false;
  ForceParts found;
  found.gravity = block<kInertialParameters>(data.still, model.parameters, 0) +
                  block<mechanism::kLegs>(data.still, model.parameters, extended::kOffset);
  found.payload_gravity = data.still.col(kPlatformMass);
  if (model.knows_motion && !(velocity.isZero(0.0) && acceleration.isZero(0.0))) {
    const CoulombWidth width{coulomb_m_per_s, coulomb_m_per_s / kTypicalLength_m};
    if (!mechanism::poseRates(*model.mechanism, pose, velocity, acceleration, motion.pose_velocity,
                              motion.pose_acceleration) ||
        !extendedRegressor(*model.mechanism, model.gravity, motion, data.regressor, data.moving, width)) {
      return false;
    }
    found.friction = block<extended::kPassiveFrictionCount>(data.moving, model.parameters, extended::kPassiveFriction) +
                     block<2 * mechanism::kLegs>(data.moving, model.parameters, extended::kViscous);
    data.moving.leftCols<kInertialParameters>() -= data.still.leftCols<kInertialParameters>();
    found.inertia = block<kInertialParameters>(data.moving, model.parameters, 0) +
                    block<mechanism::kLegs>(data.moving, model.parameters, extended::kRotor);
    found.payload_inertia = data.moving.col(kPlatformMass);
  }
  parts = found;
  return true;
}

}  // namespace knee_robot::dynamics
