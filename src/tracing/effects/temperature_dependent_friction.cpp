#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr double kReference_degC = 25.0;

/// Dry and viscous friction that change in proportion to a recorded temperature.
class TemperatureDependentFriction : public Candidate {
 public:
  std::string name() const override { return "temperature_dependent_friction"; }
  bool worksOn(const mechanism::Robot& robot) const override { return robot.chain.has_value(); }
  bool isFriction() const override { return true; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override { return "Friction follows the temperature that was recorded beside it."; }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int) const override {
    if (input.signals().temperature_degC.cols() == 0) return {};
    return {{}};
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"coulomb_per_kelvin_N", false}, {"viscous_per_kelvin_N_s_per_m", false}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    const recording::Signals& s = input.signals();
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(input.samples(), 2);
    if (s.temperature_degC.cols() == 0) return out;
    const Eigen::ArrayXd above = s.temperature_degC.col(actuator).array() - kReference_degC;
    out.col(0) = above * input.share.col(actuator).array();
    out.col(1) = above * s.velocity_m_per_s.col(actuator).array();
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeTemperatureDependentFriction() {
  return std::make_unique<TemperatureDependentFriction>();
}

}  // namespace knee_robot::tracing
