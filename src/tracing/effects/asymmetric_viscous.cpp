#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

class AsymmetricViscous : public Candidate {
 public:
  std::string name() const override { return "asymmetric_viscous"; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "Viscous friction is stronger in one direction of travel than in the other.";
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"half_difference_N_s_per_m", false}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    return input.signals().velocity_m_per_s.col(actuator).cwiseAbs();
  }
};

}  // namespace

std::unique_ptr<Candidate> makeAsymmetricViscous() {
  return std::make_unique<AsymmetricViscous>();
}

}  // namespace knee_robot::tracing
