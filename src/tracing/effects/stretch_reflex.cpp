#include <algorithm>
#include <cmath>

#include "common/line_effect.h"
#include "common/reflex.h"

namespace knee_robot::tracing {
namespace {

/// Places in the shape, after the anchors.
enum ReflexShape : std::size_t { kReflexThreshold = 5, kReflexDelay, kReflexDecay, kReflexStretch };
constexpr double kLeastThreshold = 0.005, kMostThreshold = 0.2;    ///< thresholds, m/s
constexpr double kSoonestReflex_s = 0.005, kLatestReflex_s = 0.2;  ///< delays: of a knee some 20 to 60 ms
constexpr double kBriefestReflex_s = 0.05, kLongestReflex_s = 5.0;
constexpr double kLeastStretch_m = 5e-4, kMostStretch_m = 0.2;
constexpr double kUsualDelay_s = 0.05, kUsualDecay_s = 0.5, kUsualStretch_m = 0.01;
constexpr double kThresholdsTried[] = {0.01, 0.04};
constexpr double kHipStep_m = 0.4, kReflexFactor = 1.6;  ///< of refinement

/// A muscle that is stretched faster than it bears: after a delay it pulls, along the line between a point of the base
/// (hip) and one of the platform (shank), and lets go slowly. Slow motions and shortening ones do not call it.
class StretchReflex : public RaisedLineEffect {
 public:
  std::string name() const override { return "stretch_reflex"; }
  bool needsTwoRecordings() const override { return true; }
  bool looksLikeMuch() const override { return true; }  // six machines, none of which had one
  std::string sentence() const override {
    return "A muscle between a point of the base and a point of the platform pulls, late, when it is stretched fast (a "
           "spastic catch), and lets go slowly.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    std::vector<ShapeParameter> out = RaisedLineEffect::shapeParameters();
    out.push_back({"threshold_m_per_s", kLeastThreshold, kMostThreshold});
    out.push_back({"delay_s", kSoonestReflex_s, kLatestReflex_s});
    out.push_back({"decay_s", kBriefestReflex_s, kLongestReflex_s});
    out.push_back({"stretch_m", kLeastStretch_m, kMostStretch_m});
    return out;
  }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override;
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override;
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"pull_N", true}}; }

 protected:
  Eigen::MatrixXd resistance(const Line& line, const std::vector<double>& shape) const override {
    return reflexActivation(line.rate_m_per_s, line.period_s,
                            {shape[kReflexThreshold], shape[kReflexDelay], shape[kReflexDecay], shape[kReflexStretch]});
  }
};

std::vector<std::vector<double>> StretchReflex::shapes(const EffectInput& input, int) const {
  std::vector<std::vector<double>> grid;
  for (std::vector<double> shape : anchorsToTry(input)) {
    shape.insert(shape.end(), {0.0, kUsualDelay_s, kUsualDecay_s, kUsualStretch_m});
    for (const double threshold : kThresholdsTried) {
      shape[kReflexThreshold] = threshold;
      grid.push_back(shape);
    }
  }
  return grid;
}

std::vector<std::vector<double>> StretchReflex::near(const std::vector<double>& shape, double step) const {
  std::vector<std::vector<double>> out = LineEffect::near(shape, step);
  const std::vector<ShapeParameter> limits = shapeParameters();
  for (const double sign : {-1.0, 1.0}) {
    out.push_back(shape);
    out.back()[kBaseZ] += sign * step * kHipStep_m;
    for (std::size_t k = kReflexThreshold; k <= kReflexStretch; ++k) {
      out.push_back(shape);
      out.back()[k] = std::clamp(shape[k] * std::pow(kReflexFactor, sign * step), limits[k].low, limits[k].high);
    }
  }
  return out;
}

}  // namespace

std::unique_ptr<Candidate> makeStretchReflex() {
  return std::make_unique<StretchReflex>();
}

}  // namespace knee_robot::tracing
