#include "common/ripple.h"

namespace knee_robot::tracing {
namespace {

/// A ripple that grows with what the screw carries: torque ripple of the motor, a nut that is not straight. It has
/// periods of the screw's turn:
/// one, half, a third, a quarter and a sixth of its lead.
class LoadRipple : public Ripple {
 public:
  std::string name() const override { return "load_ripple"; }
  std::string sentence() const override {
    return "The force varies periodically with the position, in proportion to what the screw carries, as the torque "
           "ripple of a motor does.";
  }
  std::vector<ShapeParameter> shapeParameters() const override { return {{"period_m", 1e-4, 1.0}}; }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override {
    const double lead_m = input.robot->actuators[static_cast<std::size_t>(actuator)].screw_lead_m;
    std::vector<std::vector<double>> all;
    for (const double order : {1.0, 2.0, 3.0, 4.0, 6.0})
      all.push_back({lead_m / order});
    return all;
  }

 protected:
  std::string unit() const override { return "_share"; }
  Eigen::VectorXd rippling(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    return input.load_N.col(actuator);
  }
};

}  // namespace

std::unique_ptr<Candidate> makeLoadRipple() {
  return std::make_unique<LoadRipple>();
}

}  // namespace knee_robot::tracing
