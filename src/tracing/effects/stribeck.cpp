#include <algorithm>
#include <cmath>

#include "common/rest_law.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

/// What is slower belongs to the law near rest, and so does what falls off before it has built up.
constexpr double kSlowestStribeck_m_per_s = 0.002, kFastestStribeck_m_per_s = 0.06, kAtLimit = 1.05,
                 kFallsAfterRise = 2.0;
/// Tustin's exponent is 1, that of most models 2. What falls off most steeply at rest is the law near rest.
constexpr double kLeastExponent = 1.0, kMostExponent = 2.0;

class Stribeck : public Candidate {
 public:
  std::string name() const override { return "stribeck"; }
  /// Beside a law that rises too early or too late, and viscous friction, it bends as drag does.
  std::string takenFor() const override { return "quadratic_drag"; }
  bool isFriction() const override { return true; }
  bool actsNearRest() const override { return true; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "Dry friction is stronger at low velocity and falls off with a characteristic velocity.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"velocity_m_per_s", kSlowestStribeck_m_per_s, kFastestStribeck_m_per_s},
            {"exponent", kLeastExponent, kMostExponent, false, kMostExponent},
            restLawParameter()};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    std::vector<std::vector<double>> grid = geometricGrid(kSlowestStribeck_m_per_s, kFastestStribeck_m_per_s, 10);
    for (std::vector<double>& shape : grid)
      shape.push_back(kMostExponent);
    return withRestLaws(grid);
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    std::vector<std::vector<double>> out = besideRestLaw(s, step);
    for (const double factor : {1.0 / 1.25, 1.25}) {
      out.push_back(
          {std::clamp(s[0] * std::pow(factor, step), kSlowestStribeck_m_per_s, kFastestStribeck_m_per_s), s[1], s[2]});
      const double exponent = std::clamp(s[1] * std::pow(factor, 2.0 * step), kLeastExponent, kMostExponent);
      out.push_back({s[0], exponent, s[2]});
    }
    return out;
  }
  bool plausibleShape(const std::vector<double>& shape) const override {
    return shape[0] > kAtLimit * kSlowestStribeck_m_per_s && shape[0] >= kFallsAfterRise * shape[2];
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"excess_N", true}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    const Eigen::ArrayXd ratio = (input.signals().velocity_m_per_s.col(actuator).array() / shape[0]).abs();
    return rubbingShare(input, actuator, shape).array() * (-ratio.pow(shape[1])).exp();
  }
};

}  // namespace

std::unique_ptr<Candidate> makeStribeck() {
  return std::make_unique<Stribeck>();
}

}  // namespace knee_robot::tracing
