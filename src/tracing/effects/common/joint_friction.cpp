#include "joint_friction.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::tracing {
namespace {

constexpr double kSteepest = 5e-4, kFlattest = 0.2;         ///< rad/s
constexpr double kStiffest_rad = 3e-4, kSoftest_rad = 0.1;  ///< of bristles
constexpr double kSpeedFactor = 2.0;

}  // namespace

ShapeParameter jointBristleParameter() {
  return {"bristle_rad", 0.0, kSoftest_rad, true, 0.0};
}

std::vector<ShapeParameter> JointFriction::shapeParameters() const {
  return {{"smooth_below_rad_per_s", kSteepest, kFlattest}, jointBristleParameter()};
}

std::vector<std::vector<double>> JointFriction::shapes(const EffectInput&, int) const {
  std::vector<std::vector<double>> out;
  for (const std::vector<double>& speed : geometricGrid(0.002, 0.05, 3))
    out.push_back({speed[0], 0.0});
  for (const std::vector<double>& bristle : geometricGrid(0.001, 0.02, 3))
    out.push_back({kSteepest, bristle[0]});
  return out;
}

std::vector<std::vector<double>> JointFriction::near(const std::vector<double>& s, double step) const {
  const double factor = std::pow(kSpeedFactor, step);
  if (s[1] > 0.0)
    return {{s[0], std::max(kStiffest_rad, s[1] / factor)}, {s[0], std::min(kSoftest_rad, s[1] * factor)}};
  return {{std::max(kSteepest, s[0] / factor), 0.0}, {std::min(kFlattest, s[0] * factor), 0.0}};
}

Eigen::MatrixXd JointFriction::columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const {
  const dynamics::JointRestLaw rest{shape[0], shape[1]};
  dynamics::JointMemory memory{};
  dynamics::PoseColumns on_pose;
  Eigen::MatrixXd out(input.samples(), count_);
  for (int n = 0; n < input.samples(); ++n) {
    const std::size_t sample = static_cast<std::size_t>(n);
    on_pose_(input.passive_joints[sample], input.observation->motion.motion[sample].pose_velocity, rest,
             n > 0 ? input.signals().period_s : 0.0, memory, on_pose);
    out.row(n) = input.force_per_pose_force[sample].row(actuator) * on_pose.leftCols(count_);
  }
  return out;
}

}  // namespace knee_robot::tracing
