#include "effects.h"

namespace knee_robot::tracing {
namespace {

class AsymmetricCoulomb : public Candidate {
 public:
  std::string name() const override { return "asymmetric_coulomb"; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "Dry friction is stronger in one direction of travel than in the other.";
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"half_difference_N", false}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    return input.share.col(actuator).cwiseAbs();
  }
};

}  // namespace

std::unique_ptr<Candidate> makeAsymmetricCoulomb() {
  return std::make_unique<AsymmetricCoulomb>();
}

}  // namespace knee_robot::tracing
