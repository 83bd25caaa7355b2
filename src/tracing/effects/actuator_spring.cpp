#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

/// Its force where it is without force by the shape is in the actuator's offset, which the baseline has.
class ActuatorSpring : public Candidate {
 public:
  std::string name() const override { return "actuator_spring"; }
  std::string sentence() const override {
    return "A spring acts along the actuator: a gas spring or counterbalance beside it, bellows, a hose.";
  }
  /// Of an arm gravity's own curves over the joints are too near.
  bool worksOn(const mechanism::Robot& robot) const override { return !robot.chain && Candidate::worksOn(robot); }
  bool restsOnModel() const override { return false; }
  bool isForceField() const override { return true; }
  int positionOf(int actuator) const override { return actuator; }
  /// The middle of the actuator's way: what the offset cannot take up.
  std::vector<ShapeParameter> shapeParameters() const override { return {{"zero_at_m", -1e3, 1e3, true}}; }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override {
    return {{input.signals().position_m.col(actuator).mean()}};
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"stiffness_N_per_m", true}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    return input.signals().position_m.col(actuator).array() - shape[0];
  }
};

}  // namespace

std::unique_ptr<Candidate> makeActuatorSpring() {
  return std::make_unique<ActuatorSpring>();
}

}  // namespace knee_robot::tracing
