#include <cmath>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

/// Dahl's friction state: ds/dx = (1 - s sign(dx)) / length, integrated exactly over each displacement.
class Presliding : public Candidate {
 public:
  std::string name() const override { return "presliding"; }
  bool isFriction() const override { return true; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "Dry friction builds up over a distance after each reversal, and keeps its value at rest (Dahl).";
  }
  std::vector<ShapeParameter> shapeParameters() const override { return {{"length_m", 2e-5, 5e-3}}; }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    return geometricGrid(2e-5, 5e-3, 10);
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"friction_N", true}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    const auto q = input.friction_position_m.col(actuator);
    Eigen::VectorXd state(input.samples());
    double s = 0.0;
    for (int n = 0; n < input.samples(); ++n) {
      const double step = n > 0 ? q[n] - q[n - 1] : 0.0;
      const double end = step >= 0.0 ? 1.0 : -1.0;
      s = end - (end - s) * std::exp(-std::abs(step) / shape[0]);
      state[n] = s;
    }
    return state;
  }
};

}  // namespace

std::unique_ptr<Candidate> makePresliding() {
  return std::make_unique<Presliding>();
}

}  // namespace knee_robot::tracing
