#include "line_between.h"

#include <cmath>

namespace knee_robot::tracing {
namespace {

constexpr double kShortest_m = 1e-6;
constexpr double kGrid_m = 0.1;  ///< step of refinement

}  // namespace

const char* const kAnchorNames[4] = {"base_x_m", "base_y_m", "platform_x_m", "platform_y_m"};

LineBetween lineBetween(const mechanism::Motion& motion, const mechanism::Matrix3& rotation, const Anchors& a) {
  const mechanism::Pose& x = motion.pose;
  const mechanism::Vector3 arm = rotation * a.platform_m;
  const mechanism::Vector3 line = mechanism::Vector3(x[0], 0.0, x[1]) + arm - a.base_m;
  LineBetween out;
  out.length_m = std::max(kShortest_m, line.norm());
  const mechanism::Vector3 direction = line / out.length_m;
  const mechanism::Vector3 by_theta(arm.z(), 0.0, -arm.x()), by_psi = rotation.col(2).cross(arm);
  out.force_on_pose << direction[0], direction[2], direction.dot(by_theta), direction.dot(by_psi);
  out.rate_m_per_s = out.force_on_pose.dot(motion.pose_velocity);
  return out;
}

LineForces lineForces(const EffectInput& input, int actuator, const Anchors& anchors) {
  LineForces out;
  out.lever.resize(input.samples());
  out.length_m.resize(input.samples());
  out.rate_m_per_s.resize(input.samples());
  for (int n = 0; n < input.samples(); ++n) {
    const std::size_t sample = static_cast<std::size_t>(n);
    const LineBetween line = lineBetween(input.observation->motion.motion[sample], input.rotation[sample], anchors);
    out.lever[n] = input.force_per_pose_force[sample].row(actuator).dot(line.force_on_pose);
    out.length_m[n] = line.length_m;
    out.rate_m_per_s[n] = line.rate_m_per_s;
  }
  return out;
}

std::vector<std::vector<double>> anchorGrid(const mechanism::Robot& robot) {
  const mechanism::Geometry& g = robot.mechanism->geometry;
  const double base = 0.8 * (g.R[0] + g.R[1] + g.R[2]) / 3.0, platform = 0.5 * (g.Rm[0] + g.Rm[1] + g.Rm[2]) / 3.0;
  std::vector<std::vector<double>> grid;
  for (const double bx : {-base, 0.0, base}) {
    for (const double by : {-base, 0.0, base}) {
      grid.push_back({bx, by, 0.0, 0.0});
      for (const double side : {-platform, platform}) {
        grid.push_back({bx, by, side, 0.0});
        grid.push_back({bx, by, 0.0, side});
      }
    }
  }
  return grid;
}

std::vector<std::vector<double>> anchorsNear(const std::vector<double>& shape, double step) {
  std::vector<std::vector<double>> out;
  for (std::size_t k = 0; k < 4; ++k) {
    for (const double side : {-kGrid_m, kGrid_m}) {
      out.push_back(shape);
      out.back()[k] += step * side;
    }
  }
  return out;
}

Anchors anchorsOf(const std::vector<double>& shape) {
  return {mechanism::Vector3(shape[0], shape[1], 0.0), mechanism::Vector3(shape[2], shape[3], 0.0)};
}

}  // namespace knee_robot::tracing
