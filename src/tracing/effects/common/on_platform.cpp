#include "on_platform.h"

namespace knee_robot::tracing {
namespace {

Eigen::MatrixXd bornBy(const EffectInput& input, int actuator, const Eigen::Matrix4Xd& on_pose) {
  Eigen::MatrixXd out(input.samples(), 1);
  for (int n = 0; n < input.samples(); ++n)
    out(n, 0) = input.force_per_pose_force[static_cast<std::size_t>(n)].row(actuator).dot(on_pose.col(n));
  return out;
}

}  // namespace

Eigen::MatrixXd OnPlatform::columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const {
  return bornBy(input, actuator, onPose(input, shape));
}

std::vector<Eigen::MatrixXd> OnPlatform::columnsOfAll(const EffectInput& input,
                                                      const std::vector<double>& shape) const {
  const Eigen::Matrix4Xd on_pose = onPose(input, shape);
  std::vector<Eigen::MatrixXd> out;
  for (int i = 0; i < input.axes(); ++i)
    out.push_back(bornBy(input, i, on_pose));
  return out;
}

}  // namespace knee_robot::tracing
