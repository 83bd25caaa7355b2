#include <algorithm>
#include <cmath>

#include "effects.h"
#include "rest_law.h"

namespace knee_robot::tracing {
namespace {

/// Friction that fades as the drive warms up from the start of the recording.
class ThermalDrift : public Candidate {
 public:
  std::string name() const override { return "thermal_drift"; }
  bool isFriction() const override { return true; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "Friction changes while the drive warms up, with a time constant, from the start of each recording.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"time_constant_s", 10.0, 300.0}, restLawParameter()};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    return withRestLaws(geometricGrid(10.0, 300.0, 4));
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    std::vector<std::vector<double>> out = besideRestLaw(s, step);
    for (const double factor : {1.0 / 1.75, 1.75})
      out.push_back({std::clamp(s[0] * std::pow(factor, step), 10.0, 300.0), s[1]});
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"coulomb_change_N", false}, {"viscous_change_N_s_per_m", false}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    Eigen::MatrixXd out(input.samples(), 2);
    const Eigen::VectorXd share = rubbingShare(input, actuator, shape);
    for (int n = 0; n < input.samples(); ++n) {
      const double warm = 1.0 - std::exp(-input.time(n) / shape[0]);
      out(n, 0) = warm * share[n];
      out(n, 1) = warm * input.signals().velocity_m_per_s(n, actuator);
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeThermalDrift() {
  return std::make_unique<ThermalDrift>();
}

}  // namespace knee_robot::tracing
