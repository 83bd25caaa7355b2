#include "../behind_springs.h"
#include "knee_robot/recording/filter.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr double kSoftest_m_per_N = 1e-4;
constexpr double kSoftest_N_per_m = 1e4, kStiffest_N_per_m = 1e6;
constexpr double kLeastShare = -0.2;  ///< of the softer legs': stiff ones have nothing but noise
constexpr double kBand =
    1.5;  ///< of the cut-off: what the fit sees is whole, and nothing is said of what it does not see

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
    return {{"share_of_friction", 0.0, 1.0, true},
            {"swings_by_N_per_m", kSoftest_N_per_m, kStiffest_N_per_m, false, kStiffest_N_per_m}};
  }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override {
    std::vector<std::vector<double>> out;
    for (const double share : {0.0, 1.0}) {
      for (const double stiffness : {3e4, 6e4, 1.5e5, kStiffest_N_per_m})
        out.push_back({share, stiffness});
    }
    return out;
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"compliance_1_to_3_m_per_N", false}, {"compliance_4_m_per_N", false}};
  }
  bool plausible(const Eigen::VectorXd& c) const override {
    return c.maxCoeff() > 0.0 && c.maxCoeff() < kSoftest_m_per_N && c.minCoeff() >= kLeastShare * c.maxCoeff();
  }
  Eigen::MatrixXd columns(const EffectInput& in, int actuator, const std::vector<double>& shape) const override {
    return columnsOfAll(in, shape)[static_cast<std::size_t>(actuator)];
  }
  std::vector<Eigen::MatrixXd> columnsOfAll(const EffectInput& in, const std::vector<double>& shape) const override {
    Eigen::MatrixXd shorter(in.samples(), in.axes());
    for (int j = 0; j < in.axes(); ++j) {  // the rotor is on the encoder's side
      shorter.col(j) =
          in.rotor_kg[j] * in.signals().acceleration_m_per_s2.col(j) - in.load_N.col(j) -
          shape[0] * (in.coulomb_N[j] * in.share.col(j) + in.viscous[j] * in.signals().velocity_m_per_s.col(j));
    }
    recording::ZeroPhaseLowPass(kBand * in.observation->cutoff_hz, 1.0 / in.signals().period_s).applyToColumns(shorter);
    Eigen::MatrixXd three = shorter, fourth = shorter;
    three.col(3).setZero();
    fourth.leftCols<3>().setZero();
    three = changeBehindSprings(in, shape[1], three);
    fourth = changeBehindSprings(in, shape[1], fourth);
    std::vector<Eigen::MatrixXd> out(static_cast<std::size_t>(in.axes()), Eigen::MatrixXd(in.samples(), 2));
    for (int i = 0; i < in.axes(); ++i)
      out[static_cast<std::size_t>(i)] << three.col(i), fourth.col(i);
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeFlexibleLegs() {
  return std::make_unique<FlexibleLegs>();
}

}  // namespace knee_robot::tracing
