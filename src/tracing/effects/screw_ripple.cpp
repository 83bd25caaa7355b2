#include <algorithm>

#include "common/ripple.h"

namespace knee_robot::tracing {
namespace {

constexpr double kLongestPeriod_m = 0.05;
/// Along the way of a recording: what comes back once, or hardly that, is friction by position.
constexpr double kFewestTurns = 2.5;

/// A ripple of the force, or (second shape parameter 1) of the dry friction, as a bent screw or a worn gear has.
class ScrewRipple : public Ripple {
 public:
  std::string name() const override { return "screw_ripple"; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "The force, or the dry friction, varies periodically with the position, as with a screw's or motor's turn.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"period_m", 0.002, kLongestPeriod_m}, {"of_friction", 0.0, 1.0, true}};
  }
  /// Fine enough that at the ends of the range the phase is off by no more than an eighth of a turn.
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override {
    const auto q = input.signals().position_m.col(actuator);
    const double range = std::max(1e-3, q.maxCoeff() - q.minCoeff());
    std::vector<std::vector<double>> grid;
    const double longest = std::min(kLongestPeriod_m, range / kFewestTurns);
    for (double turns = 1.0 / longest; turns <= 1.0 / 0.002 && grid.size() < 1000; turns += 0.5 / range) {
      for (const double of_friction : {0.0, 1.0})
        grid.push_back({1.0 / turns, of_friction});
    }
    return grid;
  }

 protected:
  std::string unit() const override { return "_N"; }
  Eigen::VectorXd rippling(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    if (shape[1] > 0.5) return input.share.col(actuator);
    return Eigen::VectorXd::Ones(input.samples());
  }
};

}  // namespace

std::unique_ptr<Candidate> makeScrewRipple() {
  return std::make_unique<ScrewRipple>();
}

}  // namespace knee_robot::tracing
