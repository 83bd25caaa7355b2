#include "knee_robot/recording/filter.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

class Delay : public Candidate {
 public:
  std::string name() const override { return "delay"; }
  bool actsFast() const override { return true; }
  std::string sentence() const override {
    return "The force acts later than its command: the command runs ahead of what the motion needs.";
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"delay_s", true}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    return recording::firstDerivative(input.force_N.col(actuator), input.signals().period_s);
  }
};

}  // namespace

std::unique_ptr<Candidate> makeDelay() {
  return std::make_unique<Delay>();
}

}  // namespace knee_robot::tracing
