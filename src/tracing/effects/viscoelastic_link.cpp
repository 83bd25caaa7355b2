#include <algorithm>
#include <cmath>

#include "common/line_effect.h"

namespace knee_robot::tracing {
namespace {

// Shorter times are a dashpot, longer ones a spring.
constexpr double kFastestLink_s = 0.05, kSlowestLink_s = 30.0;
constexpr double kLinkTimes_s[] = {0.3, 1.0, 4.0};  ///< to begin with
constexpr double kLinkFactor = 1.5;                 ///< between neighbours
constexpr std::size_t kRelaxation = 4;              ///< its place in the shape

/// A spring in series with a damper (Maxwell element) between a point of the base and a point of the platform.
class ViscoelasticLink : public LineEffect {
 public:
  std::string name() const override { return "viscoelastic_link"; }
  std::string generalizes() const override { return "dashpot"; }
  std::string sentence() const override {
    return "A spring that relaxes acts between a point of the base and a point of the platform: tissue, a strap or a "
           "rubber band.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    std::vector<ShapeParameter> out = LineEffect::shapeParameters();
    out.push_back({"relaxation_s", kFastestLink_s, kSlowestLink_s});
    return out;
  }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override {
    std::vector<std::vector<double>> grid;
    for (const std::vector<double>& anchors : LineEffect::shapes(input, actuator)) {
      for (const double time : kLinkTimes_s) {
        grid.push_back(anchors);
        grid.back().push_back(time);
      }
    }
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override {
    std::vector<std::vector<double>> out = LineEffect::near(shape, step);
    for (const double factor : {1.0 / kLinkFactor, kLinkFactor}) {
      out.push_back(shape);
      out.back()[kRelaxation] = std::clamp(shape[kRelaxation] * std::pow(factor, step), kFastestLink_s, kSlowestLink_s);
    }
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"stiffness_N_per_m", true}}; }

 protected:
  Eigen::MatrixXd resistance(const Line& line, const std::vector<double>& shape) const override {
    const double keeps = std::exp(-line.period_s / shape[kRelaxation]);
    Eigen::MatrixXd stretched_m(line.way_m.size(), 1);
    double now_m = 0.0;  // it stood before it was recorded
    for (Eigen::Index n = 0; n < stretched_m.rows(); ++n) {
      now_m = keeps * now_m + (1.0 - keeps) * shape[kRelaxation] * line.rate_m_per_s[n];
      stretched_m(n, 0) = now_m;
    }
    return stretched_m;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeViscoelasticLink() {
  return std::make_unique<ViscoelasticLink>();
}

}  // namespace knee_robot::tracing
