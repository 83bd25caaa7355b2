#include <algorithm>
#include <cmath>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr double kShortestFilter_s = 0.002, kLongestFilter_s = 0.3;
constexpr double kFilterFactor = 2.0;  ///< factor between neighbours

/// What a first-order low-pass makes of the signal, less the signal.
Eigen::VectorXd changeByFilter(const Eigen::VectorXd& signal, double filter_s, double period_s) {
  const double keeps = std::exp(-period_s / filter_s), slope = filter_s / period_s * (1.0 - keeps);
  Eigen::VectorXd out(signal.size());
  double filtered = signal[0];
  out[0] = 0.0;
  for (Eigen::Index n = 1; n < out.size(); ++n) {  // exact for a straight line between samples
    filtered = keeps * filtered + (1.0 - slope) * signal[n] + (slope - keeps) * signal[n - 1];
    out[n] = filtered - signal[n];
  }
  return out;
}

/// Of the recording, not of the robot. What is slow comes later by the coefficient; how much of what is fast comes at
/// all, the shape says: of a first-order filter both are its time constant, of a dead time the shape is short.
class SensorLag : public Candidate {
 public:
  std::string name() const override { return "sensor_lag"; }
  std::string sentence() const override {
    return "The recorded forces are behind those that act: a filter of the sensors, or of the current's reading, the "
           "same "
           "for all axes; or forces and positions have two clocks.";
  }
  bool shared() const override { return true; }
  bool worksOnBench() const override { return true; }
  bool ofDrive() const override { return true; }
  bool actsFast() const override { return true; }
  bool lags() const override { return true; }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"filter_s", kShortestFilter_s, kLongestFilter_s}};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    return geometricGrid(0.005, 0.16, 6);
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    const double factor = std::pow(kFilterFactor, step);
    return {{std::max(kShortestFilter_s, s[0] / factor)}, {std::min(kLongestFilter_s, s[0] * factor)}};
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"lag_s", true}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    return changeByFilter(input.needed_N.col(actuator), shape[0], input.signals().period_s) / shape[0];
  }
};

}  // namespace

std::unique_ptr<Candidate> makeSensorLag() {
  return std::make_unique<SensorLag>();
}

}  // namespace knee_robot::tracing
