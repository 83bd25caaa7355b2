#include "effects.h"

namespace knee_robot {
namespace {

class PositionDependentFriction : public Candidate {
 public:
  std::string name() const override { return "position_dependent_friction"; }
  std::string sentence() const override {
    return "Dry friction changes along the stroke, as with a bent screw or worn lubrication.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"from_m", -10.0, 10.0}, {"to_m", -10.0, 10.0}};
  }
  /// The range that training covers; outside it the friction stays as at its end.
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override {
    const auto q = input.signals().position_m.col(actuator);
    return {{q.minCoeff(), q.maxCoeff()}};
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"slope_N_per_m", false}, {"curvature_N_per_m2", false}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& range) const override {
    const double middle = 0.5 * (range[0] + range[1]);
    const Eigen::ArrayXd away = input.signals().position_m.col(actuator).array().max(range[0]).min(range[1]) - middle;
    Eigen::MatrixXd out(input.samples(), 2);
    out.col(0) = input.share.col(actuator).array() * away;
    out.col(1) = input.share.col(actuator).array() * away.square();
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makePositionDependentFriction() {
  return std::make_unique<PositionDependentFriction>();
}

}  // namespace knee_robot
