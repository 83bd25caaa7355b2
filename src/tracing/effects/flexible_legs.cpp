#include <algorithm>
#include <cmath>

#include "../behind_springs.h"
#include "knee_robot/recording/filter.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr double kSoftest_N_per_m = 4e3, kStiffest_N_per_m = 1e6;
constexpr double kLeastSpringDamping = 0.01, kMostSpringDamping = 0.6, kSpringDamping = 0.1;
constexpr double kAllBeside = 1.4, kLegBeside = 1.6, kSpringDampingBeside = 1.8;  ///< factors between neighbours
constexpr double kBand =
    3.0;  ///< of the cut-off: what the fit sees is whole, and nothing is said of what it does not see

/// Legs give under the load that they carry, between encoder and platform: it is elsewhere, which changes the load of
/// every leg (behind_springs.h). effects/flexible_coupling.cpp is one leg that gives much, and winds up after reversals.
class FlexibleLegs : public Candidate {
 public:
  std::string name() const override { return "flexible_coupling"; }
  std::string sentence() const override {
    return "The legs give under the load that they carry, between encoder and platform: it stands elsewhere than the "
           "encoders say, which changes the load of every leg.";
  }
  bool shared() const override { return true; }
  std::vector<ShapeParameter> shapeParameters() const override {
    std::vector<ShapeParameter> parameters = {{"share_of_friction", 0.0, 1.0, true}};
    for (int j = 1; j <= mechanism::kLegs; ++j)
      parameters.push_back({"stiffness_" + std::to_string(j) + "_N_per_m", kSoftest_N_per_m, kStiffest_N_per_m});
    parameters.push_back({"damping_ratio", kLeastSpringDamping, kMostSpringDamping});
    return parameters;
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    std::vector<std::vector<double>> out;
    for (const double share : {0.0, 1.0}) {
      for (const double stiffness : {7e3, 1.4e4, 3e4, 6e4, 1.5e5, 4e5}) {
        for (const double of_leg_4 : {1.0, 2.0})
          out.push_back({share, stiffness, stiffness, stiffness, of_leg_4 * stiffness, kSpringDamping});
      }
    }
    return out;
  }
  std::vector<std::vector<double>> near(const std::vector<double>& shape, double step) const override {
    std::vector<std::vector<double>> out;
    const auto beside = [&](std::size_t from, std::size_t to, double factor) {
      out.push_back(shape);
      for (std::size_t j = from; j <= to; ++j)
        out.back()[j] = std::clamp(out.back()[j] * factor, kSoftest_N_per_m, kStiffest_N_per_m);
    };
    for (const double sign : {-1.0, 1.0}) {
      beside(1, mechanism::kLegs, std::pow(kAllBeside, sign * step));
      for (std::size_t j = 1; j <= mechanism::kLegs; ++j)
        beside(j, j, std::pow(kLegBeside, sign * step));
      out.push_back(shape);
      out.back().back() = std::clamp(shape.back() * std::pow(kSpringDampingBeside, sign * step), kLeastSpringDamping,
                                     kMostSpringDamping);
    }
    return out;
  }
  std::vector<double> ofSize(const std::vector<double>& shape, double times) const override {
    std::vector<double> out = shape;
    for (std::size_t j = 1; j <= mechanism::kLegs; ++j)
      out[j] = std::clamp(out[j] / times, kSoftest_N_per_m, kStiffest_N_per_m);
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"share_of_forward_model", true}};
  }
  bool plausible(const Eigen::VectorXd& c) const override { return c[0] > 0.5 && c[0] < 1.6; }
  Eigen::MatrixXd columns(const EffectInput& in, int actuator, const std::vector<double>& shape) const override {
    return columnsOfAll(in, shape)[static_cast<std::size_t>(actuator)];
  }
  std::vector<Eigen::MatrixXd> columnsOfAll(const EffectInput& in, const std::vector<double>& shape) const override {
    const mechanism::Vector4 stiffness = Eigen::Map<const mechanism::Vector4>(shape.data() + 1);
    Eigen::MatrixXd longer(in.samples(), in.axes());
    for (int j = 0; j < in.axes(); ++j) {  // the rotor is on the encoder's side
      longer.col(j) =
          in.rotor_kg[j] * in.signals().acceleration_m_per_s2.col(j) - in.load_N.col(j) -
          shape[0] * (in.coulomb_N[j] * in.share.col(j) + in.viscous[j] * in.signals().velocity_m_per_s.col(j));
      longer.col(j) /= stiffness[j];
    }
    recording::ZeroPhaseLowPass(kBand * in.observation->cutoff_hz, 1.0 / in.signals().period_s).applyToColumns(longer);
    const Eigen::MatrixXd change = changeBehindSprings(in, {stiffness, shape.back()}, longer);
    std::vector<Eigen::MatrixXd> out;
    for (int i = 0; i < in.axes(); ++i)
      out.push_back(change.col(i));
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeFlexibleLegs() {
  return std::make_unique<FlexibleLegs>();
}

}  // namespace knee_robot::tracing
