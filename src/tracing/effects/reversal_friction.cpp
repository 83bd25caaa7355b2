#include <algorithm>
#include <cmath>

#include "common/rest_law.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

// Shorter ways are the law near rest, much longer ones are hardly ever travelled between two reversals.
constexpr double kShortestWay_m = 0.002, kLongestWay_m = 0.05, kLongestRise_m = 0.02;
constexpr double kRiseBeside_m = 5e-4;  ///< where the rise begins to be refined
constexpr double kWayBeside = 1.4;      ///< factor between neighbours
constexpr double kShareBeside = 0.5;    ///< of the first stroke
constexpr int kFewestReversals = 6;     ///< after which the axis went on: fewer show nothing

/// Strokes of one axis that wear the friction off.
int strokesOf(const EffectInput& input, int actuator) {
  int strokes = 0;
  for (int n = 1; n < input.samples(); ++n) {
    const double before = input.since_last_reversal_m(n - 1, actuator), now = input.since_last_reversal_m(n, actuator);
    if (before < kShortestWay_m && now >= kShortestWay_m) ++strokes;
  }
  return strokes;
}

/// What rolls wedges itself in when it turns round, and a lubricant has to be drawn in again: friction that rises over
/// one way after every reversal and falls off over a longer one, as axes of machine tools have it (a quadrant glitch).
/// Where the first stroke of a recording began is not known: only a share of the excess is there.
class ReversalFriction : public Candidate {
 public:
  std::string name() const override { return "reversal_friction"; }
  bool worksOn(const mechanism::Robot& robot) const override { return !robot.chain && Candidate::worksOn(robot); }
  bool isFriction() const override { return true; }
  bool actsNearRest() const override { return true; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "Dry friction is larger after every reversal and falls off over a way.";
  }
  bool shownIn(const EffectInput& input, int actuator) const override {
    return strokesOf(input, actuator) >= kFewestReversals;
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"way_m", kShortestWay_m, kLongestWay_m},
            {"rise_m", 0.0, kLongestRise_m},
            {"of_first_stroke", 0.0, 1.0},
            restLawParameter()};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    std::vector<std::vector<double>> grid;
    for (const std::vector<double>& way : geometricGrid(kShortestWay_m, kLongestWay_m, 6)) {
      for (const double rise_m : {0.0, 0.1, 0.4})
        grid.push_back({way[0], rise_m * way[0], 0.0});
    }
    return withRestLaws(grid);
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    std::vector<std::vector<double>> out = besideRestLaw(s, step);
    for (const double factor : {std::pow(kWayBeside, -step), std::pow(kWayBeside, step)}) {
      out.push_back({std::clamp(s[0] * factor, kShortestWay_m, kLongestWay_m), s[1], s[2], s[3]});
      out.push_back({s[0], std::min(std::max(s[1], kRiseBeside_m) * factor, kLongestRise_m), s[2], s[3]});
    }
    for (const double share : {s[2] - kShareBeside * step, s[2] + kShareBeside * step})
      out.push_back({s[0], s[1], std::clamp(share, 0.0, 1.0), s[3]});
    return out;
  }
  bool plausibleShape(const std::vector<double>& shape) const override { return shape[1] <= shape[0]; }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"excess_N", true}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    const auto way = input.since_last_reversal_m.col(actuator).array();
    Eigen::ArrayXd excess = (-way / shape[0]).exp();
    if (shape[1] > 0.0) excess *= 1.0 - (-way / shape[1]).exp();
    excess.head(input.first_turn[actuator]) *= shape[2];
    return rubbingShare(input, actuator, shape).array() * excess;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeReversalFriction() {
  return std::make_unique<ReversalFriction>();
}

}  // namespace knee_robot::tracing
