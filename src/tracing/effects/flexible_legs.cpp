#include "../length_response.h"
#include "knee_robot/recording/filter.h"

namespace knee_robot::tracing {
namespace {

constexpr double kSoftest_m_per_N = 1e-4;
constexpr double kLeastShare = -0.2;  ///< of the softer legs': stiff ones have nothing but noise

/// Legs give under the load that they carry, between encoder and platform: it is elsewhere, which changes the load of
/// every leg. To first order; effects/flexible_coupling.cpp is one leg that gives much, and winds up after reversals.
class FlexibleLegs : public Candidate {
 public:
  std::string name() const override { return "flexible_coupling"; }
  std::string sentence() const override {
    return "The legs give under the load that they carry, between encoder and platform: it stands elsewhere than the "
           "encoders say, which changes the load of every leg.";
  }
  bool shared() const override { return true; }
  std::vector<ShapeParameter> shapeParameters() const override { return {{"share_of_friction", 0.0, 1.0}}; }
  std::vector<std::vector<double>> shapes(const EffectInput&, int) const override { return {{0.0}, {0.5}, {1.0}}; }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"compliance_1_to_3_m_per_N", false}, {"compliance_4_m_per_N", false}};
  }
  bool plausible(const Eigen::VectorXd& c) const override {
    return c.maxCoeff() > 0.0 && c.maxCoeff() < kSoftest_m_per_N && c.minCoeff() >= kLeastShare * c.maxCoeff();
  }
  Eigen::MatrixXd columns(const EffectInput& in, int actuator, const std::vector<double>& shape) const override {
    Eigen::MatrixXd shorter(in.samples(), in.axes());
    for (int j = 0; j < in.axes(); ++j) {  // the rotor is on the encoder's side
      shorter.col(j) =
          in.rotor_kg[j] * in.signals().acceleration_m_per_s2.col(j) - in.load_N.col(j) -
          shape[0] * (in.coulomb_N[j] * in.share.col(j) + in.viscous[j] * in.signals().velocity_m_per_s.col(j));
    }
    recording::ZeroPhaseLowPass(in.signals().motion_cutoff_hz, 1.0 / in.signals().period_s).applyToColumns(shorter);
    const Eigen::MatrixXd each = in.by_lengths->onActuator(in, actuator, shorter);
    Eigen::MatrixXd out(each.rows(), 2);
    out << each.leftCols<3>().rowwise().sum(), each.col(3);
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeFlexibleLegs() {
  return std::make_unique<FlexibleLegs>();
}

}  // namespace knee_robot::tracing
