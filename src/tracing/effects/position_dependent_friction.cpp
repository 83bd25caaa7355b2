#include "common/rest_law.h"
#include "knee_robot/dynamics/stroke_place.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

/// A place along the stroke where friction is higher or lower; a wide one is a trend along the stroke.
class PositionDependentFriction : public Candidate {
 public:
  std::string name() const override { return "position_dependent_friction"; }
  bool isFriction() const override { return true; }
  int positionOf(int actuator) const override { return actuator; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "Dry friction changes along the stroke, as with a bent screw, a tight place or worn lubrication.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"center_m", -10.0, 10.0},
            {"width_m", 1e-3, 10.0},
            {"from_m", -10.0, 10.0, true},
            {"to_m", -10.0, 10.0, true},
            restLawParameter()};
  }
  /// The third and fourth are the range of training (see StrokePlace).
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override {
    const auto q = input.signals().position_m.col(actuator);
    const double low = q.minCoeff(), range = q.maxCoeff() - low;
    std::vector<std::vector<double>> grid;
    for (const double width : {0.1, 0.2, 0.4, 0.8}) {
      for (double place = 0.0; place <= 1.001; place += 0.5 * width)
        grid.push_back({low + place * range, width * range, low, low + range});
    }
    return withRestLaws(grid);
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    const double aside = 0.3 * step * s[1], wider = std::pow(1.5, step);
    std::vector<std::vector<double>> out = besideRestLaw(s, step);
    out.insert(out.end(), {{s[0] - aside, s[1], s[2], s[3], s[4]},
                           {s[0] + aside, s[1], s[2], s[3], s[4]},
                           {s[0], s[1] * wider, s[2], s[3], s[4]},
                           {s[0], s[1] / wider, s[2], s[3], s[4]}});
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"amplitude_N", false}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    const dynamics::StrokePlace place(shape[0], shape[1], shape[2], shape[3]);
    const Eigen::VectorXd q = input.signals().position_m.col(actuator);
    return rubbingShare(input, actuator, shape).cwiseProduct(q.unaryExpr([&](double position_m) {
      return place.at(position_m);
    }));
  }
};

}  // namespace

std::unique_ptr<Candidate> makePositionDependentFriction() {
  return std::make_unique<PositionDependentFriction>();
}

}  // namespace knee_robot::tracing
