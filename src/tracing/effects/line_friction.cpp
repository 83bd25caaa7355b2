#include <algorithm>
#include <cmath>

#include "common/line_effect.h"

namespace knee_robot::tracing {
namespace {

constexpr double kLeastSpeed_m_per_s = 2e-4, kMostSpeed_m_per_s = 0.05;
constexpr double kSpeeds_m_per_s[] = {1e-3, 5e-3};  ///< to begin with
constexpr double kSpeedFactor = 1.6;                ///< between neighbours
constexpr std::size_t kSmoothBelow = 5;             ///< its place in the shape

/// Dry friction along the line between a point of the base and a point of the platform, smooth below a speed: what rubs is
/// held by nothing that gives, unlike elastoplastic_link's.
class LineFriction : public RaisedLineEffect {
 public:
  std::string name() const override { return "line_friction"; }
  bool needsTwoRecordings() const override { return true; }
  std::string sentence() const override {
    return "A rope over a pulley, a weight balancer or a cable through a guide rubs between a point of the base and a "
           "point of the platform: dry friction against the change of their distance.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    std::vector<ShapeParameter> out = RaisedLineEffect::shapeParameters();
    out.push_back({"proportional_below_m_per_s", kLeastSpeed_m_per_s, kMostSpeed_m_per_s});
    return out;
  }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int) const override {
    std::vector<std::vector<double>> grid;
    for (std::vector<double>& anchors : anchorsToTry(input)) {
      for (const double speed : kSpeeds_m_per_s) {
        grid.push_back(anchors);
        grid.back().push_back(speed);
      }
    }
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override {
    std::vector<std::vector<double>> out = LineEffect::near(shape, step);
    for (const double factor : {1.0 / kSpeedFactor, kSpeedFactor}) {
      out.push_back(shape);
      out.back()[kSmoothBelow] =
          std::clamp(shape[kSmoothBelow] * std::pow(factor, step), kLeastSpeed_m_per_s, kMostSpeed_m_per_s);
    }
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"friction_N", true}}; }

 protected:
  Eigen::MatrixXd resistance(const Line& line, const std::vector<double>& shape) const override {
    const Eigen::ArrayXd rate = line.rate_m_per_s.array();
    return rate / (rate.square() + shape[kSmoothBelow] * shape[kSmoothBelow]).sqrt();
  }
};

}  // namespace

std::unique_ptr<Candidate> makeLineFriction() {
  return std::make_unique<LineFriction>();
}

}  // namespace knee_robot::tracing
