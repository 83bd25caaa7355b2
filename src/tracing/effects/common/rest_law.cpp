#include "rest_law.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::tracing {
namespace {

constexpr double kSmooth_m_per_s = 0.001;
constexpr double kSteepest_m_per_s = 1e-4, kFlattest_m_per_s = 5e-3;
constexpr double kWidthFactor = 2.0;

}  // namespace

ShapeParameter restLawParameter() {
  return {"smooth_below_m_per_s", 0.0, kFlattest_m_per_s, true, 0.0};
}

std::vector<std::vector<double>> withRestLaws(const std::vector<std::vector<double>>& grid) {
  return withLast(grid, {0.0, kSmooth_m_per_s});
}

std::vector<std::vector<double>> besideRestLaw(const std::vector<double>& shape, double step) {
  std::vector<std::vector<double>> out;
  for (const double factor : {1.0 / kWidthFactor, kWidthFactor}) {
    if (shape.back() == 0.0) continue;
    out.push_back(shape);
    out.back().back() = std::clamp(shape.back() * std::pow(factor, step), kSteepest_m_per_s, kFlattest_m_per_s);
  }
  return out;
}

Eigen::VectorXd rubbingShare(const EffectInput& input, int actuator, const std::vector<double>& shape) {
  if (shape.back() == 0.0) return input.share.col(actuator);
  return (input.signals().velocity_m_per_s.col(actuator).array() / shape.back()).tanh();
}

}  // namespace knee_robot::tracing
