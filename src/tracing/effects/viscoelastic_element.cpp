#include <algorithm>
#include <cmath>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

// Shorter times are a viscous friction, longer ones a spring.
constexpr double kQuickestRelaxation_s = 0.1, kSlowestRelaxation_s = 30.0;
constexpr double kOneWay = 4.0;       ///< factor between the two times of the grid
constexpr double kTimesBeside = 1.5;  ///< factor between neighbours

/// A spring in series with a damper (Maxwell element) along the actuator: bellows or tubes that leak, rubber, a film
/// that is squeezed. Valves make it relax at another pace when it was lengthened than when it was shortened.
class ViscoelasticElement : public Candidate {
 public:
  std::string name() const override { return "viscoelastic_element"; }
  std::string generalizes() const override { return "actuator_spring"; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "A spring that relaxes acts along the actuator: bellows or tubes that leak, rubber, a spring in series with "
           "a damper.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"relaxation_lengthened_s", kQuickestRelaxation_s, kSlowestRelaxation_s},
            {"relaxation_shortened_s", kQuickestRelaxation_s, kSlowestRelaxation_s}};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    std::vector<std::vector<double>> grid;
    for (const std::vector<double>& time : geometricGrid(2.0 * kQuickestRelaxation_s, kSlowestRelaxation_s, 6)) {
      for (const double factor : {1.0, 1.0 / kOneWay, kOneWay})
        grid.push_back({time[0], std::clamp(factor * time[0], kQuickestRelaxation_s, kSlowestRelaxation_s)});
    }
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    std::vector<std::vector<double>> out;
    for (const double factor : {std::pow(kTimesBeside, -step), std::pow(kTimesBeside, step)}) {
      const double first = std::clamp(factor * s[0], kQuickestRelaxation_s, kSlowestRelaxation_s);
      const double second = std::clamp(factor * s[1], kQuickestRelaxation_s, kSlowestRelaxation_s);
      out.insert(out.end(), {{first, s[1]}, {s[0], second}, {first, second}});
    }
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"stiffness_N_per_m", true}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    const auto velocity = input.signals().velocity_m_per_s.col(actuator);
    Eigen::MatrixXd stretched(input.samples(), 1);
    double now_m = 0.0;  // it stood before it was recorded
    for (int n = 0; n < input.samples(); ++n) {
      const double relaxation_s = now_m < 0.0 ? shape[1] : shape[0];
      const double keeps = n > 0 ? std::exp((input.time(n - 1) - input.time(n)) / relaxation_s) : 1.0;
      now_m = keeps * now_m + (1.0 - keeps) * relaxation_s * velocity[n];
      stretched(n, 0) = now_m;
    }
    return stretched;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeViscoelasticElement() {
  return std::make_unique<ViscoelasticElement>();
}

}  // namespace knee_robot::tracing
