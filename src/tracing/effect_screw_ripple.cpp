#include <cmath>

#include "effects.h"

namespace knee_robot::tracing {
namespace {

constexpr double kNear_per_m = 1.25;    ///< half a step of the grid over 0.2 m, per period
constexpr double kLeastSupport = 0.84;  ///< phases of two recordings within 44 degrees; at random every fourth pair is

/// Sine and cosine of the screw's phase, separately for every recording: homing may shift the phase. A ripple of the force, or (second
/// shape parameter 1) of the dry friction, as a bent screw or a worn gear has.
class ScrewRipple : public Candidate {
 public:
  std::string name() const override { return "screw_ripple"; }
  /// A chain's gears ripple at orders of a period, with a phase that the joint keeps: gear_ripple.
  bool worksOn(const mechanism::Robot& robot) const override { return !robot.chain && Candidate::worksOn(robot); }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "The force, or the dry friction, varies periodically with the position, as with a screw's or motor's turn.";
  }
  bool transfers() const override { return false; }
  bool periodic() const override { return true; }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"period_m", 0.002, 0.05}, {"of_friction", 0.0, 1.0, true}};
  }
  /// Fine enough that at the ends of the range the phase is off by no more than an eighth of a turn.
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override {
    const auto q = input.signals().position_m.col(actuator);
    const double range = std::max(1e-3, q.maxCoeff() - q.minCoeff());
    std::vector<std::vector<double>> grid;
    const double longest = std::min(0.05, 0.7 * range);
    for (double turns = 1.0 / longest; turns <= 1.0 / 0.002 && grid.size() < 1000; turns += 0.5 / range) {
      for (const double of_friction : {0.0, 1.0})
        grid.push_back({1.0 / turns, of_friction});
    }
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    const double aside = std::min(0.05, kNear_per_m * s[0]) * step;
    return {{s[0] * (1.0 - aside), s[1]}, {s[0] * (1.0 + aside), s[1]}};
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
      const double factor = shape[1] > 0.5 ? input.share(n, actuator) : 1.0;
      out(n, 2 * pair) = factor * std::sin(phase);
      out(n, 2 * pair + 1) = factor * std::cos(phase);
    }
    return out;
  }
  Eigen::VectorXd atHome(const Eigen::VectorXd& coefficients, const std::vector<int>& same_home) const override {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(coefficients.size());
    for (const int r : same_home)
      out.head<2>() += coefficients.segment<2>(2 * r) / static_cast<double>(same_home.size());
    return out;
  }
  /// The mean, times the share of it that training recordings support by agreeing: with phases at random, the square of the mean
  /// of n is as large as their spread over n. One recording cannot tell.
  Eigen::VectorXd elsewhere(const Eigen::VectorXd& coefficients) const override {
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
};

}  // namespace

std::unique_ptr<Candidate> makeScrewRipple() {
  return std::make_unique<ScrewRipple>();
}

}  // namespace knee_robot::tracing
