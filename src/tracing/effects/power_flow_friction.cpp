#include <cmath>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

/// Friction of a loaded screw or gear by direction of power flow (the directional and quadratic laws M5 and M6 of
/// Rhoban's BAM): one share of the load, and of its square, while the motor drives the load, another while the load
/// drives the motor.
class PowerFlowFriction : public Candidate {
 public:
  std::string name() const override { return "power_flow_friction"; }
  std::string generalizes() const override { return "load_dependent_friction"; }
  bool isFriction() const override { return true; }
  std::string sentence() const override {
    return "Dry friction grows with the axial force, and with its square; how much depends on whether the motor drives "
           "the load or "
           "the load drives the motor.";
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"driving_per_load", true},
            {"driven_per_load", true},
            {"driving_per_load_squared_per_N", true},
            {"driven_per_load_squared_per_N", true}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(input.samples(), 4);
    for (int n = 0; n < input.samples(); ++n) {
      const double load = std::abs(input.load_N(n, actuator)), share = input.share(n, actuator);
      const Eigen::Index driven = share * input.load_N(n, actuator) < 0.0;
      out(n, driven) = share * load;
      out(n, 2 + driven) = share * load * load;
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makePowerFlowFriction() {
  return std::make_unique<PowerFlowFriction>();
}

}  // namespace knee_robot::tracing
