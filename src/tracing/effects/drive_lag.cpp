#include "knee_robot/recording/filter.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

class DriveLag : public Candidate {
 public:
  std::string name() const override { return "drive_lag"; }
  bool actsFast() const override { return true; }
  bool leads() const override { return true; }
  std::string sentence() const override { return "The drive follows its command as a first-order lag."; }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"time_constant_s", true}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    return recording::firstDerivative(input.needed_N.col(actuator), input.signals().period_s);
  }
};

}  // namespace

std::unique_ptr<Candidate> makeDriveLag() {
  return std::make_unique<DriveLag>();
}

}  // namespace knee_robot::tracing
