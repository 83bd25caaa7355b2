#include <algorithm>
#include <cmath>

#include "common/line_effect.h"
#include "common/yielding.h"

namespace knee_robot::tracing {
namespace {

constexpr std::size_t kActsFrom = 5, kPowerOfWay = 6, kLostOver = 7, kSideOfAction = 8;  ///< in the shape
constexpr double kSoftestPower = 1.0, kHardestPower = 2.0;  ///< exponents; a sphere that is touched has 1.5
constexpr double kLeastLossWay_m = 2e-4, kUsualLossWay_m = 2e-3,
                 kMostLossWay_m = 0.02;  ///< over which what is lost comes up
constexpr double kFreeShares[] = {0.25, 0.5,
                                  0.75};  ///< of a recording's samples, that it is free in: beginnings of search
constexpr double kPerWay_m = 0.1;         ///< at which the coefficients are the force
constexpr double kLengthStep_m = 0.05, kHeightStep_m = 0.4;  ///< of refinement

/// A strap or a rope that goes taut (side 1: pulls beyond a length), a bumper, a bed or a stop that is touched (side -1:
/// pushes below it). A part of the force is lost: it changes its sign with the direction, over a
/// way, as in a webbing.
class OneSidedSpring : public RaisedLineEffect {
 public:
  std::string name() const override { return "one_sided_spring"; }
  std::string generalizes() const override { return "spring"; }
  bool needsTwoRecordings() const override { return true; }
  std::string sentence() const override {
    return "Between a point of the base and a point of the platform something acts on one side only: a strap that goes "
           "taut, a stop that is touched.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    std::vector<ShapeParameter> out = RaisedLineEffect::shapeParameters();
    out.push_back({"acts_from_m", 0.0, 5.0});
    out.push_back({"exponent", kSoftestPower, kHardestPower});
    out.push_back({"lost_over_m", kLeastLossWay_m, kMostLossWay_m});
    out.push_back({"side", -1.0, 1.0, true});
    return out;
  }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override;
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override {
    std::vector<std::vector<double>> out = LineEffect::near(shape, step);
    for (const double sign : {-step, step}) {
      out.push_back(shape);
      out.back()[kActsFrom] += sign * kLengthStep_m;
      // Where it is anchored higher, it is longer by about as much.
      out.push_back(shape);
      out.back()[kBaseZ] += sign * kHeightStep_m;
      out.back()[kActsFrom] += sign * kHeightStep_m * (shape[kBaseZ] > 0.0 ? 1.0 : -1.0);
    }
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"force_at_0.1_m_N", true}, {"lost_at_0.1_m_N", true}};
  }

 protected:
  Eigen::MatrixXd resistance(const Line& line, const std::vector<double>& shape) const override {
    const Eigen::ArrayXd within_m = (shape[kSideOfAction] * (line.length_m.array() - shape[kActsFrom])).max(0.0);
    const Eigen::ArrayXd within = (within_m / kPerWay_m).pow(shape[kPowerOfWay]);
    Eigen::MatrixXd out(within.size(), 2);
    out << shape[kSideOfAction] * within, within * yieldedShare(line.way_m, shape[kLostOver]).array();
    return out;
  }
};

std::vector<std::vector<double>> OneSidedSpring::shapes(const EffectInput& input, int) const {
  std::vector<std::vector<double>> grid;
  for (std::vector<double> shape : anchorsToTry(input)) {
    shape.insert(shape.end(), {0.0, 1.0, kUsualLossWay_m, 1.0});
    const Line line = lineBetween(input, anchors(shape));
    std::vector<double> lengths_m(line.length_m.data(), line.length_m.data() + line.length_m.size());
    std::sort(lengths_m.begin(), lengths_m.end());
    for (const double share : kFreeShares) {
      shape[kActsFrom] = lengths_m[static_cast<std::size_t>(share * static_cast<double>(lengths_m.size() - 1))];
      for (const double side : {1.0, -1.0}) {
        shape[kSideOfAction] = side;
        if (side > 0.0 || shape[kBaseZ] == 0.0) grid.push_back(shape);
      }
    }
  }
  return grid;
}

}  // namespace

std::unique_ptr<Candidate> makeOneSidedSpring() {
  return std::make_unique<OneSidedSpring>();
}

}  // namespace knee_robot::tracing
