#include "controller_pose.h"

#include <Eigen/Geometry>
#include <cmath>

namespace knee_robot::nodes {

geometry_msgs::Pose poseMessage(const mechanism::Pose& pose) {
  geometry_msgs::Pose message;
  message.position.x = pose[0];
  message.position.z = pose[1];
  const Eigen::Quaterniond turn(mechanism::platformRotation(pose));
  message.orientation.x = turn.x();
  message.orientation.y = turn.y();
  message.orientation.z = turn.z();
  message.orientation.w = turn.w();
  return message;
}

mechanism::Pose poseOf(const geometry_msgs::Pose& message) {
  const Eigen::Quaterniond turn(message.orientation.w, message.orientation.x, message.orientation.y,
                                message.orientation.z);
  const mechanism::Matrix3 rotation = turn.normalized().toRotationMatrix();
  // Ry(theta) Rz(psi): the third column is (sin theta, 0, cos theta), the second row (sin psi, cos psi, 0).
  return {message.position.x, message.position.z, std::atan2(rotation(0, 2), rotation(2, 2)),
          std::atan2(rotation(1, 0), rotation(1, 1))};
}

}  // namespace knee_robot::nodes
