#include "common/driven_load.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

class Backlash : public Candidate {
 public:
  std::string name() const override { return "backlash"; }
  bool actsFast() const override { return true; }
  std::string sentence() const override {
    return "There is play between motor and screw: when the force that it carries changes sign, the motor moves alone.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"width_m", 1e-4, 4e-3}, frictionBeyondParameter()};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    return withFrictionBeyond(geometricGrid(1e-4, 4e-3, 6));
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
    joint.half_gap_m = 0.5 * shape[0];
    joint.friction_beyond = shape[1];
    return changeByJoint(input, actuator, joint);
  }
};

}  // namespace

std::unique_ptr<Candidate> makeBacklash() {
  return std::make_unique<Backlash>();
}

}  // namespace knee_robot::tracing
