#include <cmath>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

/// Loss of a gear that winds up: a state follows the torque that the gear carries, as Dahl's friction follows a
/// displacement:
/// dz/dL = (1 - z sign(dL)) / build-up, integrated exactly over each change of the load L.
class TorsionalHysteresis : public Candidate {
 public:
  std::string name() const override { return "torsional_hysteresis"; }
  bool worksOn(const mechanism::Robot& robot) const override { return robot.chain.has_value(); }
  std::string sentence() const override {
    return "The gear winds up with a loss: what it passes on lags behind the load, one way while the load grows and "
           "the "
           "other while it falls.";
  }
  std::vector<ShapeParameter> shapeParameters() const override { return {{"build_up_N", 1e-6, 1e6}}; }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override {
    const auto load = input.load_N.col(actuator);
    const double range = load.maxCoeff() - load.minCoeff();
    if (!(range > 1e-9)) return {{1.0}};
    return geometricGrid(kFinest * range, kCoarsest * range, kGrid);
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"loss_N", true}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    const auto load = input.load_N.col(actuator);
    Eigen::VectorXd state(input.samples());
    double z = 0.0;
    for (int n = 0; n < input.samples(); ++n) {
      const double change = n > 0 ? load[n] - load[n - 1] : 0.0;
      const double end = change >= 0.0 ? 1.0 : -1.0;
      z = end - (end - z) * std::exp(-std::abs(change) / shape[0]);
      state[n] = z;
    }
    return state;
  }

 private:
  static constexpr double kFinest = 0.02, kCoarsest = 0.5;  ///< of the load's range
  static constexpr int kGrid = 6;
};

}  // namespace

std::unique_ptr<Candidate> makeTorsionalHysteresis() {
  return std::make_unique<TorsionalHysteresis>();
}

}  // namespace knee_robot::tracing
