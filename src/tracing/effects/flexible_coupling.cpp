#include "common/driven_load.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

class FlexibleCoupling : public Candidate {
 public:
  std::string name() const override { return "flexible_coupling"; }
  bool actsFast() const override { return true; }
  std::string sentence() const override {
    return "Motor and screw are joined elastically: after each reversal the joint winds up before the screw follows.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"stiffness_N_per_m", 1e4, 5e5}, frictionBeyondParameter()};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    return withFrictionBeyond(geometricGrid(1e4, 5e5, 7));
  }
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override {
    return besideJoint(shape, step, shapeParameters());
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"share_of_forward_model", true}};
  }
  bool plausible(const Eigen::VectorXd& c) const override { return c[0] > 0.5 && c[0] < 1.6; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    DriveJoint joint;
    joint.stiffness_N_per_m = shape[0];
    joint.friction_beyond = shape[1];
    return changeByJoint(input, actuator, joint);
  }
};

}  // namespace

std::unique_ptr<Candidate> makeFlexibleCoupling() {
  return std::make_unique<FlexibleCoupling>();
}

}  // namespace knee_robot::tracing
