#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

class QuadraticDrag : public Candidate {
 public:
  std::string name() const override { return "quadratic_drag"; }
  bool isFriction() const override { return true; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "Friction grows with the square of the velocity, as in churned grease or air.";
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"drag_N_s2_per_m2", true}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    return input.signals().velocity_m_per_s.col(actuator).cwiseProduct(
        input.signals().velocity_m_per_s.col(actuator).cwiseAbs());
  }
};

}  // namespace

std::unique_ptr<Candidate> makeQuadraticDrag() {
  return std::make_unique<QuadraticDrag>();
}

}  // namespace knee_robot::tracing
