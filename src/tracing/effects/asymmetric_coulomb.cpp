#include "common/rest_law.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

/// The level of friction follows the direction as far as friction has built up: (level + half of the difference *
/// share) * share.
class AsymmetricCoulomb : public Candidate {
 public:
  std::string name() const override { return "asymmetric_coulomb"; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "Dry friction is stronger in one direction of travel than in the other.";
  }
  std::vector<ShapeParameter> shapeParameters() const override { return {restLawParameter()}; }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override { return withRestLaws({{}}); }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    return besideRestLaw(s, step);
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"half_difference_N", false}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    return rubbingShare(input, actuator, shape).cwiseAbs2();
  }
};

}  // namespace

std::unique_ptr<Candidate> makeAsymmetricCoulomb() {
  return std::make_unique<AsymmetricCoulomb>();
}

}  // namespace knee_robot::tracing
