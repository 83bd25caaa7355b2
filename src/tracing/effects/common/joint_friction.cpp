#include "joint_friction.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::tracing {
namespace {

constexpr double kSteepest = 5e-4, kFlattest = 0.2;  ///< rad/s
constexpr double kSpeedFactor = 2.0;

}  // namespace

std::vector<ShapeParameter> JointFriction::shapeParameters() const {
  return {{"smooth_below_rad_per_s", kSteepest, kFlattest}};
}

std::vector<std::vector<double>> JointFriction::shapes(const EffectInput&, int) const {
  return geometricGrid(0.002, 0.05, 3);
}

std::vector<std::vector<double>> JointFriction::near(const std::vector<double>& s, double step) const {
  const double factor = std::pow(kSpeedFactor, step);
  return {{std::max(kSteepest, s[0] / factor)}, {std::min(kFlattest, s[0] * factor)}};
}

Eigen::MatrixXd JointFriction::columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const {
  dynamics::PoseColumns on_pose;
  Eigen::MatrixXd out(input.samples(), count_);
  for (int n = 0; n < input.samples(); ++n) {
    const std::size_t sample = static_cast<std::size_t>(n);
    on_pose_(input.passive_joints[sample], input.observation->motion.motion[sample].pose_velocity, shape[0], on_pose);
    out.row(n) = input.force_per_pose_force[sample].row(actuator) * on_pose.leftCols(count_);
  }
  return out;
}

}  // namespace knee_robot::tracing
