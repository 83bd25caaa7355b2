#include <algorithm>
#include <cmath>

#include "effects.h"
#include "line_between.h"

namespace knee_robot::tracing {
namespace {

/// A damper between a point of the base and a point of the platform: force c |v|^exponent against the rate v of their distance.
class Dashpot : public Candidate {
 public:
  std::string name() const override { return "dashpot"; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "A damper, or a rubbing part, acts between a point of the base and a point of the platform: its force "
           "follows a power of "
           "the rate at which their distance changes.";
  }
  bool shared() const override { return true; }
  std::vector<ShapeParameter> shapeParameters() const override {
    std::vector<ShapeParameter> out;
    for (const char* name : kAnchorNames)
      out.push_back({name, -1.0, 1.0});
    out.push_back({"exponent", 0.2, 2.0});
    return out;
  }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int) const override {
    std::vector<std::vector<double>> grid;
    for (std::vector<double>& anchors : anchorGrid(*input.robot)) {
      for (const double exponent : {0.5, 1.0}) {
        grid.push_back(anchors);
        grid.back().push_back(exponent);
      }
    }
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    std::vector<std::vector<double>> out = anchorsNear(s, step);
    for (const double factor : {1.0 / 1.4, 1.4}) {
      out.push_back(s);
      out.back()[4] = std::clamp(s[4] * std::pow(factor, step), 0.2, 2.0);
    }
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"damping_N_per_speed_power", true}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    const LineForces line = lineForces(input, actuator, anchorsOf(shape));
    const Eigen::ArrayXd speed = (line.rate_m_per_s.array().square() + kSlow * kSlow).sqrt();
    return line.lever.array() * line.rate_m_per_s.array() * speed.pow(shape[4] - 1.0);
  }

 private:
  static constexpr double kSlow = 1e-3;  ///< m/s: below it the force is proportional to the rate
};

}  // namespace

std::unique_ptr<Candidate> makeDashpot() {
  return std::make_unique<Dashpot>();
}

}  // namespace knee_robot::tracing
