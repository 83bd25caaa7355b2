#include "on_platform.h"

#include <cmath>

namespace knee_robot::tracing {
namespace {

Eigen::MatrixXd bornBy(const EffectInput& input, int actuator, const Eigen::Matrix4Xd& on_pose) {
  Eigen::MatrixXd out(input.samples(), 1);
  for (int n = 0; n < input.samples(); ++n)
    out(n, 0) = input.force_per_pose_force[static_cast<std::size_t>(n)].row(actuator).dot(on_pose.col(n));
  return out;
}

}  // namespace

Eigen::Matrix<double, 3, 4> velocityByPose(const mechanism::Matrix3& rotation, const mechanism::Vector3& arm) {
  Eigen::Matrix<double, 3, 4> out;
  out << mechanism::Vector3::UnitX(), mechanism::Vector3::UnitZ(), mechanism::Vector3(arm.z(), 0.0, -arm.x()),
      rotation.col(2).cross(arm);
  return out;
}

Eigen::Matrix2d oscillationStep(double omega, double damping, double period_s) {
  const double slow = damping * omega, fast = omega * std::sqrt(1.0 - damping * damping);
  const double keeps = std::exp(-slow * period_s), c = std::cos(fast * period_s), s = std::sin(fast * period_s) / fast;
  Eigen::Matrix2d step;
  step << keeps * (c + slow * s), keeps * s, -keeps * omega * omega * s, keeps * (c - slow * s);
  return step;
}

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
