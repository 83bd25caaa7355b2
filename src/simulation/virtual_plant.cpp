#include "knee_robot/simulation/virtual_plant.h"

#include <algorithm>

namespace knee_robot::simulation {
namespace {

/// Joint of a JointVector that each of the eleven pairs of eq. (22) belongs to: 13 12 11 23 22 21 33 32 31 42 41.
constexpr std::array<int, 11> kFrictionJoints = {2, 1, 0, 5, 4, 3, 8, 7, 6, 10, 9};

double sign(double v) {
  return v > 0.0 ? 1.0 : (v < 0.0 ? -1.0 : 0.0);
}

bool isActuated(int joint) {
  return std::find(kActuatedJoints.begin(), kActuatedJoints.end(), joint) != kActuatedJoints.end();
}

/// Force of the friction on each joint.
JointVector frictionForces(const dynamics::FrictionParameters& friction, const JointVector& rates,
                           const JointVector& shares) {
  JointVector forces = JointVector::Zero();
  for (std::size_t k = 0; k < kFrictionJoints.size(); ++k) {
    const int joint = kFrictionJoints[k];
    const Eigen::Index at = 2 * static_cast<Eigen::Index>(k);
    forces[joint] = -friction[at] * rates[joint] - friction[at + 1] * shares[joint];
  }
  return forces;
}

mechanism::Vector3 sphericalTorque(const JointFriction& friction, const mechanism::Vector3& rate) {
  const double speed = rate.norm();
  if (speed == 0.0) return mechanism::Vector3::Zero();
  return -(friction.viscous + friction.coulomb / speed) * rate;
}

}  // namespace

dynamics::FrictionParameters equalFriction(const JointFriction& actuators, const JointFriction& passive) {
  dynamics::FrictionParameters result;
  for (std::size_t k = 0; k < kFrictionJoints.size(); ++k) {
    const int joint = kFrictionJoints[k];
    const JointFriction& friction = isActuated(joint) ? actuators : passive;
    result.segment<2>(2 * static_cast<Eigen::Index>(k)) << friction.viscous, friction.coulomb;
  }
  return result;
}

VirtualPlant::VirtualPlant(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
                           const dynamics::RobotInertia& inertia, const mechanism::Pose& start,
                           const VirtualPlantParameters& parameters)
    : robot_(mechanism, gravity, inertia), parameters_(parameters) {
  mechanism::Motion rest;
  rest.pose = start;
  robot_.set(mechanism::coordinateMotion(mechanism, rest));
  last_position_ = robot_.positions();
}

JointVector VirtualPlant::coulombShares(const JointVector& rates) {
  const JointVector position = robot_.positions();
  for (int joint = 0; joint < mechanism::kUrdfJoints; ++joint) {
    const double width = isActuated(joint) ? parameters_.presliding_m : parameters_.presliding_rad;
    const double moved = position[joint] - last_position_[joint];
    share_[joint] = width > 0.0 ? std::clamp(share_[joint] + moved / width, -1.0, 1.0) : sign(rates[joint]);
  }
  last_position_ = position;
  return share_;
}

bool VirtualPlant::follow(const AxisMotion& motion, VirtualPlantOutput& output) {
  if (!robot_.follow(motion)) return false;
  const JointVector rates = robot_.rates();
  const JointVector friction = frictionForces(parameters_.friction, rates, coulombShares(rates));
  const std::array<mechanism::Vector3, 3> turning = robot_.sphericalRates();
  std::array<mechanism::Vector3, 3> torques;
  output.friction_power_W = friction.dot(rates);
  for (std::size_t i = 0; i < 3; ++i) {
    torques[i] = sphericalTorque(parameters_.spherical, turning[i]);
    output.friction_power_W += torques[i].dot(turning[i]);
  }
  output.force = robot_.actuatorForces(friction, torques) + parameters_.rotor_mass.cwiseProduct(motion.acceleration);
  output.motor_power_W = output.force.dot(motion.velocity);
  return output.force.allFinite();
}

double VirtualPlant::energy() const {
  const JointVector rates = robot_.rates();
  double rotors = 0.0;
  for (int i = 0; i < mechanism::kLegs; ++i) {
    const double rate = rates[kActuatedJoints[static_cast<std::size_t>(i)]];
    rotors += 0.5 * parameters_.rotor_mass[i] * rate * rate;
  }
  return robot_.energy() + rotors;
}

}  // namespace knee_robot::simulation
