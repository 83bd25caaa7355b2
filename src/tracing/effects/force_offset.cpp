#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

class ForceOffset : public Candidate {
 public:
  std::string name() const override { return "force_offset"; }
  std::string sentence() const override { return "The command contains a constant force."; }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"offset_N", false}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int, const std::vector<double>&) const override {
    return Eigen::VectorXd::Ones(input.samples());
  }
};

}  // namespace

std::unique_ptr<Candidate> makeForceOffset() {
  return std::make_unique<ForceOffset>();
}

}  // namespace knee_robot::tracing
