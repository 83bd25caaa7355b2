#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

class LoadDependentViscous : public Candidate {
 public:
  std::string name() const override { return "load_dependent_viscous"; }
  bool isFriction() const override { return true; }
  std::string sentence() const override {
    return "Viscous friction of the screw grows with the axial force that it carries.";
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"viscous_per_load_s_per_m", true}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    return input.signals().velocity_m_per_s.col(actuator).cwiseProduct(input.load_N.col(actuator).cwiseAbs());
  }
};

}  // namespace

std::unique_ptr<Candidate> makeLoadDependentViscous() {
  return std::make_unique<LoadDependentViscous>();
}

}  // namespace knee_robot::tracing
