#include <cmath>

#include "effects.h"

namespace knee_robot::tracing {
namespace {

constexpr double kSamePhase = 0.4;  ///< largest deviation from the mean, in amplitudes

/// Sine and cosine of the screw's phase, separately for every recording: homing may shift the phase.
class ScrewRipple : public Candidate {
 public:
  std::string name() const override { return "screw_ripple"; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "The force varies periodically with the position, as with a screw's or motor's turn.";
  }
  bool transfers() const override { return false; }
  std::vector<ShapeParameter> shapeParameters() const override { return {{"period_m", 0.002, 0.05}}; }
  /// Fine enough that at the ends of the range the phase is off by no more than an eighth of a turn.
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override {
    const auto q = input.signals().position_m.col(actuator);
    const double range = std::max(1e-3, q.maxCoeff() - q.minCoeff());
    std::vector<std::vector<double>> grid;
    const double longest = std::min(0.05, 0.7 * range);
    for (double turns = 1.0 / longest; turns <= 1.0 / 0.002 && grid.size() < 600; turns += 0.5 / range)
      grid.push_back({1.0 / turns});
    return grid;
  }
  std::vector<Coefficient> coefficients(const EffectInput& input) const override {
    std::vector<Coefficient> out;
    for (int r = 1; r <= input.recordings; ++r) {
      const std::string place = input.recordings > 1 ? "_in_recording_" + std::to_string(r) : "";
      out.push_back({"sine_N" + place, false});
      out.push_back({"cosine_N" + place, false});
    }
    return out;
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(input.samples(), 2 * input.recordings);
    const int pair = std::max(0, input.recording);  // elsewhere() puts the common phase into the first pair
    const auto q = input.signals().position_m.col(actuator);
    for (int n = 0; n < input.samples(); ++n) {
      const double phase = 2.0 * M_PI / shape[0] * q[n];
      out(n, 2 * pair) = std::sin(phase);
      out(n, 2 * pair + 1) = std::cos(phase);
    }
    return out;
  }
  /// The mean, when training recordings agree on the phase: homing does not shift it then. One recording cannot tell.
  Eigen::VectorXd elsewhere(const Eigen::VectorXd& coefficients) const override {
    const Eigen::Index recordings = coefficients.size() / 2;
    const Eigen::Map<const Eigen::Matrix2Xd> pairs(coefficients.data(), 2, recordings);
    const Eigen::Vector2d mean = pairs.rowwise().mean();
    if (recordings < 2 || (pairs.colwise() - mean).colwise().norm().maxCoeff() > kSamePhase * mean.norm()) return {};
    Eigen::VectorXd out = Eigen::VectorXd::Zero(coefficients.size());
    out.head<2>() = mean;
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeScrewRipple() {
  return std::make_unique<ScrewRipple>();
}

}  // namespace knee_robot::tracing
