#include "common/warm_up.h"

namespace knee_robot::tracing {
namespace {

constexpr int kUsualForce = 3;  ///< of the shape
constexpr double kLargest_N = 1e6;

/// The drive's gain, force per volt, that changes as its motor warms up: a magnet that is hot gives less torque per
/// ampere. The force that is recorded follows from the voltage, so that the mechanism seems to need more.
class GainDrift : public WarmUp {
 public:
  std::string name() const override { return "gain_drift"; }
  std::string sentence() const override {
    return "The force that a drive gives per volt changes while its motor warms up, with a time constant; not all "
           "recordings begin equally warm.";
  }
  int usualForce() const override { return kUsualForce; }
  std::vector<ShapeParameter> shapeParameters() const override {
    std::vector<ShapeParameter> out = WarmUp::shapeParameters();
    out[kHeatedBy] = heatedByParameter(dynamics::Heat::Winding);
    out.push_back({"usual_force_N", 0.0, kLargest_N, true, 0.0});
    return out;
  }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override {
    std::vector<std::vector<double>> out = WarmUp::shapes(input, actuator);
    for (std::vector<double>& shape : out)
      shape.push_back(0.0);
    return out;
  }
  /// A share of the force: what doubles it is none.
  bool plausible(const Eigen::VectorXd& coefficients) const override {
    return coefficients.cwiseAbs().maxCoeff() < 0.5;
  }

 protected:
  std::vector<std::string> changes() const override { return {"change"}; }
  Eigen::MatrixXd changing(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    return input.force_N.col(actuator);
  }
};

}  // namespace

std::unique_ptr<Candidate> makeGainDrift() {
  return std::make_unique<GainDrift>();
}

}  // namespace knee_robot::tracing
