#include "effects.h"

namespace knee_robot {
namespace {

class PositionDependentFriction : public Candidate {
 public:
  std::string name() const override { return "position_dependent_friction"; }
  std::string sentence() const override {
    return "Dry friction changes along the stroke, as with a bent screw or worn lubrication.";
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"slope_N_per_m", false}, {"curvature_N_per_m2", false}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    const Actuator& a = input.robot->actuators[static_cast<std::size_t>(actuator)];
    const double middle = 0.5 * (a.position_min_m + a.position_max_m);
    const Eigen::ArrayXd away = input.signals().position_m.col(actuator).array() - middle;
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
