#include "warm_up.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "knee_robot/dynamics/warming.h"

namespace knee_robot::tracing {
namespace {

constexpr double kShortestTime_s = 10.0, kLongestTime_s = 300.0;
constexpr int kConstants = 4;         ///< in the grid
constexpr double kTimeFactor = 1.75;  ///< between neighbours
constexpr double kLeastUsual_N = 1e-3;

dynamics::HeatSource heatedBy(const WarmUp& kind, const std::vector<double>& shape) {
  const double levels_off = kind.levelsOff() < 0 ? 0.0 : shape[static_cast<std::size_t>(kind.levelsOff())];
  return {dynamics::heatOf(shape[WarmUp::kHeatedBy]).value_or(dynamics::Heat::Clock), shape[WarmUp::kViscousHeat],
          levels_off};
}

/// How warm the actuator's drive is along a recording that begins cold; `usual_N`: at which force its windings' heat is 1.
std::vector<double> warmthAlong(const EffectInput& input, int actuator, const dynamics::HeatSource& by,
                                double time_constant_s, double usual_N) {
  const auto velocity = input.signals().velocity_m_per_s.col(actuator);
  std::vector<double> out(static_cast<std::size_t>(input.samples()), 0.0);
  dynamics::Warmth warmth;
  for (int n = 1; n < input.samples(); ++n) {
    const double period_s = input.time(n) - input.time(n - 1), share = input.force_N(n, actuator) / usual_N;
    out[static_cast<std::size_t>(n)] = by.by == dynamics::Heat::Winding
                                           ? warmth.warm(share * share, period_s, time_constant_s)
                                           : warmth.move(by, velocity[n], period_s, time_constant_s);
  }
  return out;
}

}  // namespace

ShapeParameter heatedByParameter(dynamics::Heat last) {
  return {"heated_by", 0.0, dynamics::numberOf(last), true, dynamics::numberOf(dynamics::Heat::Clock)};
}

std::vector<ShapeParameter> WarmUp::shapeParameters() const {
  return {{"time_constant_s", kShortestTime_s, kLongestTime_s},
          heatedByParameter(),
          {"viscous_heat_s_per_m", 0.0, kMostViscous_s_per_m, true, 0.0}};
}

std::vector<std::vector<double>> WarmUp::shapes(const EffectInput&, int) const {
  std::vector<std::vector<double>> out = geometricGrid(kShortestTime_s, kLongestTime_s, kConstants);
  for (std::vector<double>& shape : out)
    shape.insert(shape.end(), {dynamics::numberOf(dynamics::Heat::Clock), 0.0});
  return out;
}

std::vector<std::vector<double>> WarmUp::near(const std::vector<double>& shape, double step) const {
  std::vector<std::vector<double>> out;
  for (const double factor : {1.0 / kTimeFactor, kTimeFactor}) {
    out.push_back(shape);
    out.back()[0] = std::clamp(shape[0] * std::pow(factor, step), kShortestTime_s, kLongestTime_s);
  }
  return out;
}

std::vector<Coefficient> WarmUp::coefficients(const EffectInput& input) const {
  std::vector<Coefficient> out;
  for (const std::string& change : changes())
    out.push_back({change, false});
  for (int r = 2; r <= input.recordings; ++r) {
    for (const std::string& change : changes())
      out.push_back({change + "_at_start_of_recording_" + std::to_string(r), false});
  }
  return out;
}

Eigen::MatrixXd WarmUp::columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const {
  const Eigen::MatrixXd change = changing(input, actuator, shape);
  const double usual_N =
      usualForce() < 0 ? 1.0 : std::max(kLeastUsual_N, shape[static_cast<std::size_t>(usualForce())]);
  const dynamics::HeatSource by = heatedBy(*this, shape);
  const std::vector<double> warm = warmthAlong(input, actuator, by, shape[0], usual_N);
  const bool worked = by.by == dynamics::Heat::Worked;
  Eigen::MatrixXd out(change.rows(), change.cols() * std::max(1, input.recordings));
  for (Eigen::Index n = 0; n < change.rows(); ++n) {
    const double own = warm[static_cast<std::size_t>(n)];
    const double cold = worked ? 1.0 - own : std::exp(-input.time(static_cast<int>(n)) / shape[0]);
    out.row(n).head(change.cols()) = dynamics::felt(by, own) * change.row(n);
    // What it began with fades in time, whatever heats it; what had been worked less, by work. The first recording takes
    // what all others have more, so that the mean is nought.
    for (int r = 1; r < input.recordings; ++r) {
      const double of_this = input.recording == r ? cold : input.recording == 0 ? -cold : 0.0;
      out.row(n).segment(change.cols() * r, change.cols()) = of_this * change.row(n);
    }
  }
  return out;
}

Eigen::VectorXd WarmUp::elsewhere(const Eigen::VectorXd& coefficients) const {
  const auto own = static_cast<Eigen::Index>(changes().size());
  Eigen::VectorXd out = Eigen::VectorXd::Zero(coefficients.size());
  out.head(own) = coefficients.head(own);
  return out;
}

}  // namespace knee_robot::tracing
