#include <algorithm>
#include <cmath>
#include <string>

#include "effects.h"
#include "rest_law.h"

namespace knee_robot::tracing {
namespace {

constexpr Eigen::Index kOwn = 2;  ///< coefficients that every recording shares

/// Friction that changes as the drive warms up from the start of the recording. Recordings need not begin equally warm: each after the
/// first may begin with more or less friction than the mean of all, which fades with the same time constant.
class ThermalDrift : public Candidate {
 public:
  std::string name() const override { return "thermal_drift"; }
  bool isFriction() const override { return true; }
  bool restsOnModel() const override { return false; }
  std::string sentence() const override {
    return "Friction changes while the drive warms up, with a time constant, from the start of each recording; not all "
           "begin equally warm.";
  }
  std::vector<ShapeParameter> shapeParameters() const override {
    return {{"time_constant_s", 10.0, 300.0}, restLawParameter()};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    return withRestLaws(geometricGrid(10.0, 300.0, 4));
  }
  std::vector<std::vector<double>> near(const std::vector<double>& s, double step) const override {
    std::vector<std::vector<double>> out = besideRestLaw(s, step);
    for (const double factor : {1.0 / 1.75, 1.75})
      out.push_back({std::clamp(s[0] * std::pow(factor, step), 10.0, 300.0), s[1]});
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput& input) const override {
    std::vector<Coefficient> out = {{"coulomb_change_N", false}, {"viscous_change_N_s_per_m", false}};
    for (int r = 2; r <= input.recordings; ++r) {
      const std::string place = "_in_recording_" + std::to_string(r);
      out.push_back({"coulomb_at_start_N" + place, false});
      out.push_back({"viscous_at_start_N_s_per_m" + place, false});
    }
    return out;
  }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>& shape) const override {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(input.samples(), kOwn * std::max(1, input.recordings));
    const Eigen::VectorXd share = rubbingShare(input, actuator, shape);
    for (int n = 0; n < input.samples(); ++n) {
      const double cold = std::exp(-input.time(n) / shape[0]);
      const double velocity = input.signals().velocity_m_per_s(n, actuator);
      out.row(n).head<kOwn>() << (1.0 - cold) * share[n], (1.0 - cold) * velocity;
      // The first recording takes what all others have more, so that the mean is nought.
      for (int r = 1; r < input.recordings; ++r) {
        const double of_this = input.recording == r ? cold : input.recording == 0 ? -cold : 0.0;
        out.row(n).segment<kOwn>(kOwn * r) << of_this * share[n], of_this * velocity;
      }
    }
    return out;
  }
  /// A recording that nobody trained on begins as warm as those of training did in the mean.
  Eigen::VectorXd elsewhere(const Eigen::VectorXd& coefficients) const override {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(coefficients.size());
    out.head<kOwn>() = coefficients.head<kOwn>();
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeThermalDrift() {
  return std::make_unique<ThermalDrift>();
}

}  // namespace knee_robot::tracing
