#include <algorithm>
#include <cmath>

#include "common/first_settled.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr double kSlowestBelow_m_per_s = 3e-4, kFastestBelow_m_per_s = 5e-3;
/// After which the current falls. Sooner, a drive would cut it in every reversal of a slow axis, and what shows there is
/// friction.
constexpr double kSoonest_s = 0.2, kLatest_s = 3.0;
constexpr double kQuickest_s = 0.05, kSlowest_s = 2.0;      ///< its time constant
constexpr double kComesBack_s = 0.1;                        ///< drives give all again at the first step
constexpr double kIdleBeside = 1.5;                         ///< factor between neighbours
constexpr double kLeastLeft = 1.0 / 3.0;                    ///< of the current
constexpr double kRestSpeed_m_per_s = 1e-3, kRest_s = 0.5;  ///< what shows it
constexpr int kIdleRests = 3;

/// Rests of one axis that are long enough for a drive to cut its current.
int idleRestsOf(const EffectInput& input, int actuator) {
  const auto velocity = input.signals().velocity_m_per_s.col(actuator);
  int rests = 0;
  double stood_s = 0.0;
  for (int n = 1; n < input.samples(); ++n) {
    const double before_s = stood_s;
    stood_s = std::abs(velocity[n]) < kRestSpeed_m_per_s ? stood_s + input.time(n) - input.time(n - 1) : 0.0;
    if (before_s < kRest_s && stood_s >= kRest_s) ++rests;
  }
  return rests;
}

/// A drive that was left with its idle current reduction (standstill current, current cutback) on: once its axis has
/// stood for a while it gives less force than it is told to, and all of it as soon as the axis moves.
class IdleCurrentReduction : public Candidate {
 public:
  std::string name() const override { return "idle_current_reduction"; }
  bool ofDrive() const override { return true; }
  std::string sentence() const override {
    return "The drive cuts its current once the axis has stood for a while, and gives less force than it is told to: "
           "idle current reduction.";
  }
  bool shownIn(const EffectInput& input, int actuator) const override {
    return idleRestsOf(input, actuator) >= kIdleRests;
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"below_m_per_s", kSlowestBelow_m_per_s, kFastestBelow_m_per_s},
            {"after_s", kSoonest_s, kLatest_s},
            {"time_constant_s", kQuickest_s, kSlowest_s}};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    std::vector<std::vector<double>> grid;
    for (const double below_m_per_s : {6e-4, 2e-3, 4e-3}) {
      for (const double after_s : {kSoonest_s, 0.45, 1.0}) {
        for (const double constant_s : {0.1, 0.5})
          grid.push_back({below_m_per_s, after_s, constant_s});
      }
    }
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    const std::vector<ShapeParameter> bounds = shapeParameters();
    std::vector<std::vector<double>> out;
    for (std::size_t k = 0; k < s.size(); ++k) {
      for (const double factor : {std::pow(kIdleBeside, -step), std::pow(kIdleBeside, step)}) {
        out.push_back(s);
        out.back()[k] = std::clamp(s[k] * factor, bounds[k].low, bounds[k].high);
      }
    }
    return out;
  }
  /// A drive that gives 1 / (1 + c) of its command has to be told 1 + c times what the motion needs.
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"told_more_by", true}}; }
  bool plausible(const Eigen::VectorXd& coefficients) const override {
    return coefficients[0] < 1.0 / kLeastLeft - 1.0;
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    Eigen::MatrixXd out = input.needed_N.col(actuator);
    const auto velocity = input.signals().velocity_m_per_s.col(actuator);
    const bool stands = std::abs(velocity[0]) < shape[0];  // then it did so before it was recorded
    double stood_s = stands ? kLatest_s : 0.0, idle = stands ? 1.0 : 0.0;
    for (int n = 0; n < input.samples(); ++n) {
      const double period_s = n > 0 ? input.time(n) - input.time(n - 1) : 0.0;
      stood_s = std::abs(velocity[n]) < shape[0] ? stood_s + period_s : 0.0;
      const bool cut = stood_s >= shape[1];
      const double settled = cut ? 1.0 : 0.0;
      idle = settled + (idle - settled) * std::exp(-period_s / (cut ? shape[2] : kComesBack_s));
      out(n, 0) *= idle;
    }
    // What friction holds until an axis first moves is nobody's evidence.
    if (input.recording >= 0) out.topRows(firstSettled(input, actuator)).setZero();
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeIdleCurrentReduction() {
  return std::make_unique<IdleCurrentReduction>();
}

}  // namespace knee_robot::tracing
