#include "knee_robot/identification/prediction.h"

namespace knee_robot {

Eigen::MatrixXd predictForce(const Model& model, const Robot& robot, const Signals& s, const MotionPath& path) {
  const ForceModel force_model(model, robot);
  ForceModelData data;
  Eigen::MatrixXd out(s.samples(), robot.axes());
  Vector4 forces = Vector4::Zero();
  int first_known = -1;
  for (int n = 0; n < s.samples(); ++n) {
    const std::size_t i = static_cast<std::size_t>(n);
    const Motion motion = path.motion.empty() ? Motion() : path.motion[i];
    if (path.pose_known[i]) {
      Vector4 here;
      const bool ok = forceFromModel(force_model, actuatorRow(s.position_m, n), actuatorRow(s.velocity_m_per_s, n),
                                     actuatorRow(s.acceleration_m_per_s2, n), motion, data, here);
      if (ok && here.allFinite()) {
        forces = here;
        if (first_known < 0) first_known = n;
      }
    }
    out.row(n) = forces.head(robot.axes()).transpose();
  }
  for (int n = 0; n < first_known; ++n)
    out.row(n) = out.row(first_known);
  return out;
}

}  // namespace knee_robot
