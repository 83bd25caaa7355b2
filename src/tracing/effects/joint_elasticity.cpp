#include "knee_robot/recording/filter.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

/// A gear that gives, seen by two encoders: rotor and the motor's own friction follow the motor, which runs ahead of
/// the joint by how far the gear is wound up.
class JointElasticity : public Candidate {
 public:
  std::string name() const override { return "joint_elasticity"; }
  bool worksOn(const mechanism::Robot& robot) const override { return robot.chain.has_value(); }
  bool actsFast() const override { return true; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "The gear gives: rotor and friction follow the motor's encoder, which runs ahead of the joint's.";
  }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int) const override {
    if (input.signals().motor_m.cols() == 0) return {};
    return {{}};
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"rotor_kg", true}, {"motor_viscous_N_s_per_m", true}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    const recording::Signals& s = input.signals();
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(input.samples(), 2);
    if (s.motor_m.cols() == 0) return out;
    const Eigen::VectorXd wound = s.motor_m.col(actuator) - s.position_m.col(actuator);
    out.col(0) = recording::secondDerivative(wound, s.period_s);
    out.col(1) = recording::firstDerivative(wound, s.period_s);
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeJointElasticity() {
  return std::make_unique<JointElasticity>();
}

}  // namespace knee_robot::tracing
