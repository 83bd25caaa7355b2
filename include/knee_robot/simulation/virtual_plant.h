#pragma once

#include "knee_robot/dynamics/parameters.h"
#include "knee_robot/simulation/simbody_robot.h"

namespace knee_robot::simulation {

/// Viscous (N s/m, N m s/rad) and Coulomb (N, N m) friction of one joint.
struct JointFriction {
  double viscous = 0.0;
  double coulomb = 0.0;
};

/// Friction and rotors of the virtual plant.
struct VirtualPlantParameters {
  dynamics::FrictionParameters friction =
      dynamics::FrictionParameters::Zero();  ///< of the 11 leg joints of eq. (23), in the order of eq. (22)
  /// Of each spherical joint: a torque against the relative angular velocity. The paper's model has no such term.
  JointFriction spherical;
  mechanism::Vector4 rotor_mass =
      mechanism::Vector4::Zero();  ///< kg, reflected to the actuators; the paper leaves it out
  /// Displacement (m, rad) over which the Coulomb friction of the leg joints builds up and reverses, and which it
  /// remembers at rest (simulation packages call it stiction displacement). 0: the sign of the velocity, nothing at
  /// rest.
  double presliding_m = 0.0;
  double presliding_rad = 0.0;
};

/// The same friction in all actuators and in all seven passive joints of the legs, in the order of eq. (22).
dynamics::FrictionParameters equalFriction(const JointFriction& actuators, const JointFriction& passive);

/// What the plant did at one instant.
struct VirtualPlantOutput {
  mechanism::Vector4 force = mechanism::Vector4::Zero();  ///< N, exerted by the actuators
  double motor_power_W = 0.0;                             ///< of these forces
  double friction_power_W = 0.0;  ///< of all friction; never positive unless presliding gives back
};

/// Stand-in for the virtual plant of section 3.1.1 (there Adams/View): takes the motion of the four actuators and gives
/// the forces that they must exert, with friction in the joints. Built on Simbody, independent of the project's
/// kinematics, dynamics and regressor. Without presliding a joint at rest (velocity exactly zero) has no Coulomb
/// friction: a prescribed motion does not determine it.
class VirtualPlant {
 public:
  /// Starts assembled at `start`, a pose of the branch in which the robot was built.
  VirtualPlant(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
               const dynamics::RobotInertia& inertia, const mechanism::Pose& start,
               const VirtualPlantParameters& parameters);

  /// Moves on to `motion` (a small step from the last one) and fills `output`. False when the closed mechanism cannot
  /// follow.
  bool follow(const AxisMotion& motion, VirtualPlantOutput& output);

  /// Kinetic (rotors included) and potential energy, J.
  double energy() const;
  const SimbodyRobot& robot() const { return robot_; }

 private:
  /// Share of full Coulomb friction of each leg joint, in [-1, 1].
  JointVector coulombShares(const JointVector& rates);

  SimbodyRobot robot_;
  VirtualPlantParameters parameters_;
  JointVector share_ = JointVector::Zero();
  JointVector last_position_;
};

}  // namespace knee_robot::simulation
