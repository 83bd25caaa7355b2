#include <algorithm>
#include <cmath>

#include "effects.h"
#include "line_between.h"

namespace knee_robot::tracing {
namespace {

/// A damper with a valve between a point of the base and a point of the platform: one that resists lengthening and shortening differently.
class AsymmetricDashpot : public Candidate {
 public:
  std::string name() const override { return "asymmetric_dashpot"; }
  std::string generalizes() const override { return "dashpot"; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "A damper acts between a point of the base and a point of the platform and resists lengthening and "
           "shortening differently, as one with a valve does.";
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
    return {{"damping_lengthening_N_per_speed_power", true}, {"damping_shortening_N_per_speed_power", true}};
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    const LineForces line = lineForces(input, actuator, anchorsOf(shape));
    const Eigen::ArrayXd speed = (line.rate_m_per_s.array().square() + kSlow * kSlow).sqrt();
    const Eigen::VectorXd factor = line.lever.array() * speed.pow(shape[4] - 1.0);
    Eigen::MatrixXd out(input.samples(), 2);
    out << factor.cwiseProduct(line.rate_m_per_s.cwiseMax(0.0)), factor.cwiseProduct(line.rate_m_per_s.cwiseMin(0.0));
    return out;
  }

 private:
  static constexpr double kSlow = 1e-3;  ///< m/s: below it the force is proportional to the rate
};

}  // namespace

std::unique_ptr<Candidate> makeAsymmetricDashpot() {
  return std::make_unique<AsymmetricDashpot>();
}

}  // namespace knee_robot::tracing
