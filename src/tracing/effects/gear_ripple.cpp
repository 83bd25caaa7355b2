#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/quantile.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr int kOrders[] = {1, 2,
                           4};  ///< of a harmonic drive: a turn of the motor, its wave generator twice, both splines
constexpr int kEach = 2 * static_cast<int>(std::size(kOrders));

constexpr double kShortest_m = 0.002, kLongest_m = 0.05;
constexpr double kSeenShare = 0.25;       ///< of the samples, at which the first order must lie below the cut-off
constexpr double kMotionOverForce = 5.0;  ///< low-pass of positions over that of forces, at most

/// Shortest period that is not for the low-pass alone to see: at a quarter of the samples the joint is slow enough for
/// it. Below that the remainders of a few stops look like a ripple.
double shortestSeen(const recording::Signals& s, int actuator) {
  std::vector<double> speed(static_cast<std::size_t>(s.samples()));
  for (int n = 0; n < s.samples(); ++n)
    speed[static_cast<std::size_t>(n)] = std::abs(s.velocity_m_per_s(n, actuator));
  return std::max(kShortest_m, quantile(std::move(speed), kSeenShare) * kMotionOverForce / s.motion_cutoff_hz);
}

/// Torque ripple of a gear at one, two and four times a period of the joint's position, which is searched. The phase is
/// the joint's own:
/// an arm knows its joints' angles, so that it is the same in every recording.
class GearRipple : public Candidate {
 public:
  std::string name() const override { return "gear_ripple"; }
  bool worksOn(const mechanism::Robot& robot) const override { return robot.chain.has_value(); }
  bool restsOnModel() const override { return false; }
  bool periodic() const override { return true; }
  std::string sentence() const override {
    return "The gear's torque ripples at one, two and four times a period of the joint's angle, as that of a harmonic "
           "drive.";
  }
  int positionOf(int actuator) const override { return actuator; }
  std::vector<ShapeParameter> shapeParameters() const override { return {{"period_m", kShortest_m, kLongest_m}}; }
  /// The second order's phase is off by no more than an eighth of a turn at the ends of the range.
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override {
    const auto q = input.signals().position_m.col(actuator);
    const double range = std::max(1e-3, q.maxCoeff() - q.minCoeff());
    const double longest = std::min(kLongest_m, 0.7 * range), shortest = shortestSeen(input.signals(), actuator);
    std::vector<std::vector<double>> grid;
    for (double turns = 1.0 / longest; turns <= 1.0 / shortest && grid.size() < 600; turns += 0.25 / range)
      grid.push_back({1.0 / turns});
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    const double aside = std::min(0.03, 0.6 * s[0]) * step;
    return {{s[0] * (1.0 - aside)}, {s[0] * (1.0 + aside)}};
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    std::vector<Coefficient> out;
    for (const int order : kOrders) {
      out.push_back({"sine_" + std::to_string(order) + "_N", false});
      out.push_back({"cosine_" + std::to_string(order) + "_N", false});
    }
    return out;
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    Eigen::MatrixXd out(input.samples(), kEach);
    const Eigen::ArrayXd phase = kTwoPi / shape[0] * input.signals().position_m.col(actuator).array();
    for (std::size_t k = 0; k < std::size(kOrders); ++k) {
      out.col(2 * static_cast<Eigen::Index>(k)) = (kOrders[k] * phase).sin();
      out.col(2 * static_cast<Eigen::Index>(k) + 1) = (kOrders[k] * phase).cos();
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeGearRipple() {
  return std::make_unique<GearRipple>();
}

}  // namespace knee_robot::tracing
