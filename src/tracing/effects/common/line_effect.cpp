#include "line_effect.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace knee_robot::tracing {
namespace {

constexpr double kShortestLine_m = 1e-6;
constexpr double kStep_m = 0.1;         ///< of refinement
constexpr double kSlow_m_per_s = 1e-3;  ///< below it a damper's force is proportional to the rate
constexpr std::size_t kExponent = 4;    ///< its place in a damper's shape
constexpr double kLowest = 0.2, kHighest = 2.0, kFactor = 1.4;  ///< of exponents, and between neighbours

/// At one sample.
struct LineNow {
  double length_m = 0.0, rate_m_per_s = 0.0;
  mechanism::Vector4
      force_on_pose;  ///< generalized force (N, N, N m, N m) that lengthens it, per newton along the line
};

LineNow lineNow(const mechanism::Motion& motion, const mechanism::Matrix3& rotation, const Anchors& a) {
  const mechanism::Pose& x = motion.pose;
  const mechanism::Vector3 arm = rotation * a.platform_m;
  const mechanism::Vector3 line = mechanism::Vector3(x[0], 0.0, x[1]) + arm - a.base_m;
  LineNow out;
  out.length_m = std::max(kShortestLine_m, line.norm());
  const mechanism::Vector3 direction = line / out.length_m;
  const mechanism::Vector3 by_theta(arm.z(), 0.0, -arm.x()), by_psi = rotation.col(2).cross(arm);
  out.force_on_pose << direction[0], direction[2], direction.dot(by_theta), direction.dot(by_psi);
  out.rate_m_per_s = out.force_on_pose.dot(motion.pose_velocity);
  return out;
}

}  // namespace

Line lineBetween(const EffectInput& input, const Anchors& anchors) {
  Line out;
  out.period_s = input.signals().period_s;
  out.lever.resize(input.samples(), input.axes());
  out.length_m.resize(input.samples());
  out.rate_m_per_s.resize(input.samples());
  out.way_m.resize(input.samples());
  for (int n = 0; n < input.samples(); ++n) {
    const std::size_t sample = static_cast<std::size_t>(n);
    const LineNow line = lineNow(input.observation->motion.motion[sample], input.rotation[sample], anchors);
    out.lever.row(n) = (input.force_per_pose_force[sample] * line.force_on_pose).transpose();
    out.length_m[n] = line.length_m;
    out.rate_m_per_s[n] = line.rate_m_per_s;
    out.way_m[n] =
        n > 0 ? 0.5 * (line.rate_m_per_s + out.rate_m_per_s[n - 1]) * (input.time(n) - input.time(n - 1)) : 0.0;
  }
  return out;
}

Anchors anchorsOf(const std::vector<double>& shape) {
  return {mechanism::Vector3(shape[0], shape[1], 0.0), mechanism::Vector3(shape[2], shape[3], 0.0)};
}

std::vector<Anchors> crossOfAnchors(const mechanism::Robot& robot) {
  const mechanism::Geometry& g = robot.mechanism->geometry;
  const double base = 0.8 * (g.R[0] + g.R[1] + g.R[2]) / 3.0, platform = 0.5 * (g.Rm[0] + g.Rm[1] + g.Rm[2]) / 3.0;
  const auto cross = [](double arm) {
    return std::array<mechanism::Vector3, 5>{mechanism::Vector3::Zero(), arm * mechanism::Vector3::UnitX(),
                                             -arm * mechanism::Vector3::UnitX(), arm * mechanism::Vector3::UnitY(),
                                             -arm * mechanism::Vector3::UnitY()};
  };
  std::vector<Anchors> all;
  for (const mechanism::Vector3& below : cross(base)) {
    for (const mechanism::Vector3& above : cross(platform))
      all.push_back({below, above});
  }
  return all;
}

std::vector<ShapeParameter> LineEffect::shapeParameters() const {
  std::vector<ShapeParameter> out;
  for (const char* name : {"base_x_m", "base_y_m", "platform_x_m", "platform_y_m"})
    out.push_back({name, -1.0, 1.0});
  return out;
}

// A coarse grid that the robot's radii span.
std::vector<std::vector<double>> LineEffect::shapes(const EffectInput& input, int) const {
  const mechanism::Geometry& g = input.robot->mechanism->geometry;
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

std::vector<std::vector<double>> LineEffect::near(const std::vector<double>& shape, double step) const {
  std::vector<std::vector<double>> out;
  for (std::size_t k = 0; k < 4; ++k) {
    for (const double side : {-kStep_m, kStep_m}) {
      out.push_back(shape);
      out.back()[k] += step * side;
    }
  }
  return out;
}

Eigen::MatrixXd LineEffect::columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const {
  const Line line = lineBetween(input, anchors(shape));
  return line.lever.col(actuator).asDiagonal() * resistance(line, shape);
}

std::vector<Eigen::MatrixXd> LineEffect::columnsOfAll(const EffectInput& input,
                                                      const std::vector<double>& shape) const {
  const Line line = lineBetween(input, anchors(shape));
  const Eigen::MatrixXd per_coefficient_N = resistance(line, shape);
  std::vector<Eigen::MatrixXd> out;
  for (int i = 0; i < input.axes(); ++i)
    out.push_back(line.lever.col(i).asDiagonal() * per_coefficient_N);
  return out;
}

std::vector<ShapeParameter> RaisedLineEffect::shapeParameters() const {
  std::vector<ShapeParameter> out = LineEffect::shapeParameters();
  out.push_back({"base_z_m", -3.0, 3.0});
  return out;
}

Anchors RaisedLineEffect::anchors(const std::vector<double>& shape) const {
  Anchors both = LineEffect::anchors(shape);
  both.base_m.z() = shape[kBaseZ];
  return both;
}

std::vector<std::vector<double>> RaisedLineEffect::anchorsToTry(const EffectInput& input) {
  double height_m = 0.0;
  for (const mechanism::Motion& m : input.observation->motion.motion)
    height_m += m.pose[1] / input.samples();
  std::vector<std::vector<double>> out;
  for (const Anchors& a : crossOfAnchors(*input.robot)) {
    for (const double z : {0.0, 2.0 * height_m})
      out.push_back({a.base_m.x(), a.base_m.y(), a.platform_m.x(), a.platform_m.y(), z});
  }
  return out;
}

std::vector<ShapeParameter> LineDamper::shapeParameters() const {
  std::vector<ShapeParameter> out = LineEffect::shapeParameters();
  out.push_back({"exponent", kLowest, kHighest});
  return out;
}

std::vector<std::vector<double>> LineDamper::shapes(const EffectInput& input, int actuator) const {
  std::vector<std::vector<double>> grid;
  for (std::vector<double>& anchors : LineEffect::shapes(input, actuator)) {
    for (const double exponent : {0.5, 1.0}) {
      grid.push_back(anchors);
      grid.back().push_back(exponent);
    }
  }
  return grid;
}

std::vector<std::vector<double>> LineDamper::near(const std::vector<double>& shape, double step) const {
  std::vector<std::vector<double>> out = LineEffect::near(shape, step);
  for (const double factor : {1.0 / kFactor, kFactor}) {
    out.push_back(shape);
    out.back()[kExponent] = std::clamp(shape[kExponent] * std::pow(factor, step), kLowest, kHighest);
  }
  return out;
}

Eigen::ArrayXd LineDamper::powerOfRate(const Line& line, const std::vector<double>& shape) {
  const Eigen::ArrayXd speed = (line.rate_m_per_s.array().square() + kSlow_m_per_s * kSlow_m_per_s).sqrt();
  return line.rate_m_per_s.array() * speed.pow(shape[kExponent] - 1.0);
}

}  // namespace knee_robot::tracing
