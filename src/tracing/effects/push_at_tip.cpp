#include "common/push_window.h"
#include "knee_robot/dynamics/chain_regressor.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

/// A push at a chain's tip link: a constant force at its origin, base frame, during part of one recording.
class PushAtTip : public PushWindow {
 public:
  bool worksOn(const mechanism::Robot& robot) const override { return robot.chain.has_value(); }
  std::string sentence() const override {
    return "Something pushed the tip link during part of one recording; this cannot happen again in another one.";
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"force_x_N", false}, {"force_y_N", false}, {"force_z_N", false}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(input.samples(), 3);
    if (input.recording + 1 != static_cast<int>(shape[0])) return out;
    const mechanism::Chain& chain = *input.robot->chain;
    Eigen::VectorXd per_m(input.axes());
    for (int i = 0; i < input.axes(); ++i)
      per_m[i] = input.robot->actuators[static_cast<std::size_t>(i)].position_per_m();
    const Samples window = samplesOf(input, actuator, shape);
    for (int n = window.begin; n < window.end; ++n) {
      const Eigen::VectorXd q = input.signals().position_m.row(n).transpose().cwiseProduct(per_m);
      const auto jacobian = dynamics::chainJacobian(chain, q, chain.tip.translation());
      out.row(n) = -per_m[actuator] * jacobian.col(actuator).head<3>().transpose();
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makePushAtTip() {
  return std::make_unique<PushAtTip>();
}

}  // namespace knee_robot::tracing
