#include "ripple.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"

namespace knee_robot::tracing {
namespace {

constexpr double kLeastSupport = 0.84;  ///< phases of two recordings within 44 degrees; at random every fourth pair is
constexpr double kNear_per_m = 1.25;    ///< half a step of a grid over 0.2 m, per period

}  // namespace

std::vector<std::vector<double>> Ripple::near(const std::vector<double>& shape, double step) const {
  const double aside = std::min(0.05, kNear_per_m * shape[0]) * step;
  std::vector<std::vector<double>> out(2, shape);
  out[0][0] *= 1.0 - aside;
  out[1][0] *= 1.0 + aside;
  return out;
}

std::vector<Coefficient> Ripple::coefficients(const EffectInput& input) const {
  std::vector<Coefficient> out;
  for (int r = 1; r <= input.recordings; ++r) {
    const std::string place = input.recordings > 1 ? "_in_recording_" + std::to_string(r) : "";
    out.push_back({"sine" + unit() + place, false});
    out.push_back({"cosine" + unit() + place, false});
  }
  return out;
}

Eigen::MatrixXd Ripple::columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(input.samples(), 2 * input.recordings);
  const int pair = std::max(0, input.recording);  // elsewhere() puts the common phase into the first pair
  const Eigen::ArrayXd phase = kTwoPi / shape[0] * input.signals().position_m.col(actuator).array();
  const Eigen::ArrayXd factor = rippling(input, actuator, shape);
  out.col(2 * pair) = factor * phase.sin();
  out.col(2 * pair + 1) = factor * phase.cos();
  return out;
}

Eigen::VectorXd Ripple::atHome(const Eigen::VectorXd& coefficients, const std::vector<int>& same_home) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(coefficients.size());
  for (const int r : same_home)
    out.head<2>() += coefficients.segment<2>(2 * r) / static_cast<double>(same_home.size());
  return out;
}

Eigen::VectorXd Ripple::elsewhere(const Eigen::VectorXd& coefficients) const {
  const Eigen::Index recordings = coefficients.size() / 2;
  const Eigen::Map<const Eigen::Matrix2Xd> pairs(coefficients.data(), 2, recordings);
  const Eigen::Vector2d mean = pairs.rowwise().mean();
  if (recordings < 2) return {};
  const double spread = (pairs.colwise() - mean).squaredNorm() / static_cast<double>(recordings - 1);
  const double support = 1.0 - spread / std::max(1e-300, static_cast<double>(recordings) * mean.squaredNorm());
  if (!(support > kLeastSupport)) return {};
  Eigen::VectorXd out = Eigen::VectorXd::Zero(coefficients.size());
  out.head<2>() = support * mean;
  return out;
}

}  // namespace knee_robot::tracing
