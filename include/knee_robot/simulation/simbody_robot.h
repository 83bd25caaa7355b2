#pragma once

#include <array>
#include <memory>

#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/mechanism/constraints.h"
#include "knee_robot/mechanism/leg_motion.h"

namespace knee_robot::simulation {

/// One number per joint of the robot as Simbody builds it, in the order of urdfJointNames():
/// q11 q12 q13 q21 q22 q23 q31 q32 q33 q41 q42 theta_4 psi_4 (rad and m; forces N m and N).
using JointVector = Eigen::Matrix<double, mechanism::kUrdfJoints, 1>;
/// Places of the four actuated joints in a JointVector.
inline constexpr std::array<int, mechanism::kLegs> kActuatedJoints = {2, 5, 8, 10};

/// Motion of the four actuators at one instant (m, m/s, m/s^2).
struct AxisMotion {
  mechanism::Vector4 position = mechanism::Vector4::Zero();
  mechanism::Vector4 velocity = mechanism::Vector4::Zero();
  mechanism::Vector4 acceleration = mechanism::Vector4::Zero();
};

/// The robot in another engine: a Simbody multibody system of the same link inertias, with its own joints, its loops
/// closed by three ball constraints, and its own kinematics. Shares no kinematic, dynamic or regressor code with this
/// project, so that it can contradict it. Not real-time safe. Rotors are not part of it.
class SimbodyRobot {
 public:
  SimbodyRobot(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
               const dynamics::RobotInertia& inertia);
  ~SimbodyRobot();

  /// Positions and velocities of all joints, taken over as they are.
  void set(const mechanism::CoordinateMotion& motion);
  /// Moves the actuators to `motion` and solves Simbody's own constraints for the other nine joints, from where they
  /// are now.
  /// False when that does not converge, or the constraints are singular there.
  bool follow(const AxisMotion& motion);

  JointVector positions() const;
  JointVector rates() const;
  /// Angular velocity of the platform against the tips of legs 1 to 3 (the spherical joints), base frame, rad/s.
  std::array<mechanism::Vector3, 3> sphericalRates() const;

  /// Accelerations of the four actuators under these actuator forces (N).
  mechanism::Vector4 actuatorAccelerations(const mechanism::Vector4& actuator_forces);
  /// Forces of the platform on the tips of legs 1 to 3 (N, base frame) in the state of the last actuatorAccelerations.
  std::array<mechanism::Vector3, 3> ballForces(const mechanism::Vector4& actuator_forces) const;
  /// Actuator forces (N) for these accelerations: Simbody's tree residual, projected by its own constraint matrix.
  mechanism::Vector4 actuatorForces(const mechanism::CoordinateMotion& motion);
  /// The same for the motion of the last follow(), while `joint_forces` (N, N m) act in the joints and
  /// `spherical_torques` (N m, base frame) on the platform and, reversed, on the tips of legs 1 to 3.
  mechanism::Vector4 actuatorForces(const JointVector& joint_forces,
                                    const std::array<mechanism::Vector3, 3>& spherical_torques);

  /// Kinetic energy, and kinetic plus potential energy (J).
  double kineticEnergy() const;
  double energy() const;

 private:
  struct System;
  std::unique_ptr<System> system_;
};

}  // namespace knee_robot::simulation
