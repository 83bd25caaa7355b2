#include "common/line_effect.h"

namespace knee_robot::tracing {
namespace {

/// A damper with a valve between a point of the base and a point of the platform: one that resists lengthening and
/// shortening differently.
class AsymmetricDashpot : public LineDamper {
 public:
  std::string name() const override { return "asymmetric_dashpot"; }
  std::string generalizes() const override { return "dashpot"; }
  std::string sentence() const override {
    return "A damper acts between a point of the base and a point of the platform and resists lengthening and "
           "shortening differently, as one with a valve does.";
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"damping_lengthening_N_per_speed_power", true}, {"damping_shortening_N_per_speed_power", true}};
  }

 protected:
  Eigen::MatrixXd resistance(const Line& line, const std::vector<double>& shape) const override {
    const Eigen::VectorXd both = powerOfRate(line, shape);
    Eigen::MatrixXd out(both.size(), 2);
    out << both.cwiseMax(0.0), both.cwiseMin(0.0);
    return out;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeAsymmetricDashpot() {
  return std::make_unique<AsymmetricDashpot>();
}

}  // namespace knee_robot::tracing
