#pragma once

#include <knee_robot/Margins.h>
#include <knee_robot/Residual.h>
#include <knee_robot/Timing.h>
#include <sensor_msgs/JointState.h>

#include <vector>

#include "knee_robot/control/control_system.h"
#include "knee_robot/mechanism/kinematics.h"

/// Messages from what the controller knows, without publishing: header and frame are the caller's.
namespace knee_robot::nodes {

/// q11 q12 q13 q21 q22 q23 q31 q32 q33 q41 q42 Xm Zm theta psi: positions (m, rad), velocities, and as effort the
/// actuator forces (N; 0 for passive joints). Velocities are left out where the Jacobian is singular.
sensor_msgs::JointState coordinatesMessage(const mechanism::Mechanism& mechanism, const mechanism::Pose& pose,
                                           const control::TrackingRow& row);

/// The URDF's 13 joints.
sensor_msgs::JointState urdfJointsMessage(const mechanism::Mechanism& mechanism, const mechanism::Pose& pose);

/// `pose`: nullptr when none belongs to the lengths.
Margins marginsMessage(const mechanism::Robot& robot, const mechanism::Pose* pose, const control::TrackingRow& row);

/// Numbers of the disturbance observer, and what they say in plain words.
Residual residualMessage(const control::Disturbance& disturbance);

/// `before`: two snapshots an activity of the window's begin (lateness, execution); replaced by those of now.
Timing timingMessage(const rt::Deployment& deployment, std::vector<rt::DurationHistogram::Snapshot>& before);

}  // namespace knee_robot::nodes
