#include <cmath>
#include <string>

#include "effects.h"

namespace knee_robot::tracing {
namespace {

/// The drive's gain, force per volt, that changes as its motor warms up: a magnet that is hot gives less torque per ampere. The force that is recorded
/// follows from the voltage, so that the mechanism seems to need more. Recordings need not begin equally warm (effect_thermal_drift.cpp).
class GainDrift : public Candidate {
 public:
  std::string name() const override { return "gain_drift"; }
  std::string sentence() const override {
    return "The force that a drive gives per volt changes while its motor warms up, with a time constant; not all "
           "recordings begin equally warm.";
  }
  std::vector<ShapeParameter> shapeParameters() const override { return {{"time_constant_s", 10.0, 300.0}}; }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    return geometricGrid(10.0, 300.0, 4);
  }
  std::vector<Coefficient> coefficients(const EffectInput& input) const override {
    std::vector<Coefficient> out = {{"change", false}};
    for (int r = 2; r <= input.recordings; ++r)
      out.push_back({"change_at_start_in_recording_" + std::to_string(r), false});
    return out;
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(input.samples(), std::max(1, input.recordings));
    for (int n = 0; n < input.samples(); ++n) {
      const double cold = std::exp(-input.time(n) / shape[0]), force = input.force_N(n, actuator);
      out(n, 0) = (1.0 - cold) * force;
      for (int r = 1; r < input.recordings; ++r)
        out(n, r) = (input.recording == r ? cold : input.recording == 0 ? -cold : 0.0) * force;
    }
    return out;
  }
  Eigen::VectorXd elsewhere(const Eigen::VectorXd& coefficients) const override {
    return coefficients[0] * Eigen::VectorXd::Unit(coefficients.size(), 0);
  }
  /// A share of the force: what doubles it is none.
  bool plausible(const Eigen::VectorXd& coefficients) const override {
    return coefficients.cwiseAbs().maxCoeff() < 0.5;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeGainDrift() {
  return std::make_unique<GainDrift>();
}

}  // namespace knee_robot::tracing
