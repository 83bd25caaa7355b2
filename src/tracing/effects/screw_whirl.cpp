#include <algorithm>
#include <cmath>

#include "knee_robot/dynamics/whirl.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr double kSlowest_m_per_s = 0.02, kFastest_m_per_s = 0.4;  ///< critical speeds
constexpr int kCriticalSpeeds = 7;
constexpr double kWidths[] = {0.1, 0.3};  ///< of the critical speed, to begin with
constexpr double kNarrowest_m_per_s = 2e-3, kWidest_m_per_s = 0.2;
constexpr double kWhirlStep = 1.3;     ///< between neighbours
constexpr double kNarrowerThan = 1.0;  ///< times the critical speed: what is wider is a law of friction of all speeds

/// A leg's screw (or its belt) near its critical speed: a drag that peaks at a speed, at a lower one where the leg is long.
class ScrewWhirl : public Candidate {
 public:
  std::string name() const override { return "screw_whirl"; }
  bool isFriction() const override { return true; }
  bool restsOnModel() const override { return false; }
  bool worksOn(const mechanism::Robot& robot) const override { return robot.mechanism.has_value(); }
  std::string sentence() const override {
    return "The screw whirls near its critical speed, which falls with the square of its free length: a drag that "
           "peaks there.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"critical_m_per_s", kSlowest_m_per_s, kFastest_m_per_s},
            {"width_m_per_s", kNarrowest_m_per_s, kWidest_m_per_s},
            {"at_length_m", 0.0, 10.0, true}};
  }
  /// Peaks that the motion passes: of one beyond it only the rise would show, which drag has as well.
  bool shownIn(const EffectInput& input, int actuator) const override {
    return fastest(input, actuator) > kSlowest_m_per_s;
  }
  std::vector<std::vector<double>> shapes(const EffectInput& input, int actuator) const override {
    const auto q = input.signals().position_m.col(actuator);
    const double middle_m = 0.5 * (q.minCoeff() + q.maxCoeff());
    std::vector<std::vector<double>> grid;
    for (const std::vector<double>& critical : geometricGrid(kSlowest_m_per_s, kFastest_m_per_s, kCriticalSpeeds)) {
      if (critical[0] > kSlowest_m_per_s && critical[0] > fastest(input, actuator)) break;
      for (const double width : kWidths)
        grid.push_back({critical[0], std::max(kNarrowest_m_per_s, width * critical[0]), middle_m});
    }
    return grid;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    std::vector<std::vector<double>> out;
    for (const double factor : {std::pow(kWhirlStep, -step), std::pow(kWhirlStep, step)}) {
      out.push_back({std::clamp(s[0] * factor, kSlowest_m_per_s, kFastest_m_per_s), s[1], s[2]});
      out.push_back({s[0], std::clamp(s[1] * factor * factor, kNarrowest_m_per_s, kWidest_m_per_s), s[2]});
    }
    return out;
  }
  bool plausibleShape(const std::vector<double>& shape) const override { return shape[1] < kNarrowerThan * shape[0]; }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"peak_N", true}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    const dynamics::Whirl whirl{shape[0], shape[1], shape[2]};
    const recording::Signals& signals = input.signals();
    Eigen::VectorXd out(input.samples());
    for (Eigen::Index n = 0; n < out.size(); ++n)
      out[n] = whirl.share(signals.position_m(n, actuator), signals.velocity_m_per_s(n, actuator));
    return out;
  }

 private:
  static double fastest(const EffectInput& input, int actuator) {
    return input.signals().velocity_m_per_s.col(actuator).cwiseAbs().maxCoeff();
  }
};

}  // namespace

std::unique_ptr<Candidate> makeScrewWhirl() {
  return std::make_unique<ScrewWhirl>();
}

}  // namespace knee_robot::tracing
