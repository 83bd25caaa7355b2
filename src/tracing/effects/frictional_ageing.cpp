#include <algorithm>
#include <cmath>

#include "common/rest_law.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

// Shorter times and ways are the law near rest: a bristle's, a stop's.
constexpr double kShortestTime_s = 0.3, kLongestTime_s = 10.0;
constexpr double kShortestWay_m = 0.002, kLongestWay_m = 0.05;
constexpr double kAgeingBeside = 1.5;  ///< factor between neighbours
constexpr double kStands_m_per_s = 5e-4;
constexpr int kRests = 3;  ///< of the shortest time and followed by the shortest way: fewer show nothing

/// Rests of one axis after which it goes on.
int restsOf(const EffectInput& input, int actuator) {
  const auto velocity = input.signals().velocity_m_per_s.col(actuator);
  int rests = 0;
  double stood_s = 0.0, way_m = kShortestWay_m;
  for (int n = 1; n < input.samples(); ++n) {
    const double period_s = input.time(n) - input.time(n - 1);
    if (std::abs(velocity[n]) < kStands_m_per_s) {
      if (way_m >= kShortestWay_m) stood_s += period_s;
      if (stood_s >= kShortestTime_s) way_m = 0.0;
      continue;
    }
    const bool rested = stood_s >= kShortestTime_s;
    way_m += std::abs(velocity[n]) * period_s;
    if (rested && way_m >= kShortestWay_m) ++rests;
    if (!rested || way_m >= kShortestWay_m) stood_s = 0.0;
  }
  return rests;
}

/// Asperities in contact grow and lubricant is squeezed out while the axis stands; a way of some millimetres wears it
/// off: the state of Dieterich's and Ruina's law, with an end.
class FrictionalAgeing : public Candidate {
 public:
  std::string name() const override { return "frictional_ageing"; }
  bool isFriction() const override { return true; }
  bool actsNearRest() const override { return true; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "Dry friction grows while the axis rests, with a time constant, and wears off over a way.";
  }
  bool shownIn(const EffectInput& input, int actuator) const override { return restsOf(input, actuator) >= kRests; }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"time_constant_s", kShortestTime_s, kLongestTime_s},
            {"way_m", kShortestWay_m, kLongestWay_m},
            restLawParameter()};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    std::vector<std::vector<double>> grid;
    for (const std::vector<double>& time : geometricGrid(kShortestTime_s, kLongestTime_s, 4)) {
      for (const std::vector<double>& way : geometricGrid(kShortestWay_m, kLongestWay_m, 4))
        grid.push_back({time[0], way[0]});
    }
    return withRestLaws(grid);
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    std::vector<std::vector<double>> out = besideRestLaw(s, step);
    for (const double factor : {std::pow(kAgeingBeside, -step), std::pow(kAgeingBeside, step)}) {
      out.push_back({std::clamp(s[0] * factor, kShortestTime_s, kLongestTime_s), s[1], s[2]});
      out.push_back({s[0], std::clamp(s[1] * factor, kShortestWay_m, kLongestWay_m), s[2]});
    }
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"aged_N", true}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    Eigen::MatrixXd out = rubbingShare(input, actuator, shape);
    const auto velocity = input.signals().velocity_m_per_s.col(actuator);
    double worn = 0.0;  // the robot stood before it was recorded
    for (int n = 0; n < input.samples(); ++n) {
      const double wears = std::abs(velocity[n]) / shape[1], rate = wears + 1.0 / shape[0];
      const double period_s = n > 0 ? input.time(n) - input.time(n - 1) : 0.0;
      worn = wears / rate + (worn - wears / rate) * std::exp(-rate * period_s);
      out(n, 0) *= 1.0 - worn;
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeFrictionalAgeing() {
  return std::make_unique<FrictionalAgeing>();
}

}  // namespace knee_robot::tracing
