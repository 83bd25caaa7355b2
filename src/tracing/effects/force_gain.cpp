#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

class ForceGain : public Candidate {
 public:
  std::string name() const override { return "force_gain"; }
  std::string sentence() const override {
    return "The commanded force differs from the true one by a factor: a wrong force constant of this actuator.";
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"relative_error", false}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    return input.force_N.col(actuator);
  }
};

}  // namespace

std::unique_ptr<Candidate> makeForceGain() {
  return std::make_unique<ForceGain>();
}

}  // namespace knee_robot::tracing
