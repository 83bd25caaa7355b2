#include <algorithm>
#include <cmath>

#include "common/line_effect.h"
#include "common/yielding.h"

namespace knee_robot::tracing {
namespace {

constexpr double kShortestYield_m = 5e-4, kLongestYield_m = 0.05;
constexpr double kYields_m[] = {2e-3, 1e-2};  ///< to begin with
constexpr double kYieldFactor = 1.6;          ///< between neighbours
constexpr std::size_t kYield = 5;             ///< its place in the shape

/// A spring in series with a slider (Jenkins element, smooth as by Dahl) between a point of the base and a point of the
/// platform.
class ElastoplasticLink : public RaisedLineEffect {
 public:
  std::string name() const override { return "elastoplastic_link"; }
  std::string sentence() const override {
    return "A cable, an energy chain or a limb between a point of the base and a point of the platform gives "
           "elastically and then yields: dry friction that builds up with the change of their distance.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    std::vector<ShapeParameter> out = RaisedLineEffect::shapeParameters();
    out.push_back({"yield_m", kShortestYield_m, kLongestYield_m});
    return out;
  }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int) const override {
    std::vector<std::vector<double>> grid;
    for (std::vector<double>& anchors : anchorsToTry(input)) {
      for (const double yield : kYields_m) {
        grid.push_back(anchors);
        grid.back().push_back(yield);
      }
    }
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override {
    std::vector<std::vector<double>> out = LineEffect::near(shape, step);
    for (const double factor : {1.0 / kYieldFactor, kYieldFactor}) {
      out.push_back(shape);
      out.back()[kYield] = std::clamp(shape[kYield] * std::pow(factor, step), kShortestYield_m, kLongestYield_m);
    }
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"yield_N", true}}; }

 protected:
  Eigen::MatrixXd resistance(const Line& line, const std::vector<double>& shape) const override {
    return yieldedShare(line.way_m, shape[kYield]);
  }
};

}  // namespace

std::unique_ptr<Candidate> makeElastoplasticLink() {
  return std::make_unique<ElastoplasticLink>();
}

}  // namespace knee_robot::tracing
