#include "common/rest_law.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

class LoadDependentFriction : public Candidate {
 public:
  std::string name() const override { return "load_dependent_friction"; }
  bool isFriction() const override { return true; }
  std::string sentence() const override {
    return "Dry friction of the screw grows with the axial force that it carries.";
  }
  std::vector<ShapeParameter> shapeParameters() const override { return {restLawParameter()}; }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override { return withRestLaws({{}}); }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    return besideRestLaw(s, step);
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"friction_per_load", true}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    return rubbingShare(input, actuator, shape).cwiseProduct(input.load_N.col(actuator).cwiseAbs());
  }
};

}  // namespace

std::unique_ptr<Candidate> makeLoadDependentFriction() {
  return std::make_unique<LoadDependentFriction>();
}

}  // namespace knee_robot::tracing
