#include "common/warm_up.h"

namespace knee_robot::tracing {
namespace {

/// The drive's gain, force per volt, that changes as its motor warms up: a magnet that is hot gives less torque per
/// ampere. The force that is recorded follows from the voltage, so that the mechanism seems to need more.
class GainDrift : public WarmUp {
 public:
  std::string name() const override { return "gain_drift"; }
  std::string sentence() const override {
    return "The force that a drive gives per volt changes while its motor warms up, with a time constant; not all "
           "recordings begin equally warm.";
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
