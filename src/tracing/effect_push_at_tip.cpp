#include <algorithm>
#include <cmath>

#include "effects.h"
#include "knee_robot/dynamics/chain_regressor.h"

namespace knee_robot::tracing {
namespace {

/// A push at a chain's tip link: a constant force at its origin, base frame, during part of one recording.
class PushAtTip : public Candidate {
 public:
  std::string name() const override { return "external_force"; }
  bool worksOn(const mechanism::Robot& robot) const override { return robot.chain.has_value(); }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "Something pushed the tip link during part of one recording; this cannot happen again in another one.";
  }
  bool shared() const override { return true; }
  bool transfers() const override { return false; }
  bool local() const override { return true; }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"recording", 1.0, 1e3, true}, {"from_s", 0.0, 1e6, true}, {"duration_s", 0.5, 1e3, true}};
  }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int) const override {
    std::vector<std::vector<double>> grid;
    const double end = input.time(input.samples() - 1);
    for (const double duration : {1.0, 2.0, 4.0, 8.0}) {
      if (duration > 0.5 * end) continue;
      for (double from = 0.0; from + duration <= end; from += std::max(0.5 * duration, end / 60.0))
        grid.push_back({input.recording + 1.0, from, duration});
    }
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    const double aside = 0.25 * step * s[2], longer = std::pow(1.4, step);
    return {{s[0], s[1] - aside, s[2]},
            {s[0], s[1] + aside, s[2]},
            {s[0], s[1], s[2] * longer},
            {s[0], s[1], s[2] / longer}};
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
    for (int n = 0; n < input.samples(); ++n) {
      const double since = input.time(n) - shape[1];
      if (since < 0.0 || since > shape[2]) continue;
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
