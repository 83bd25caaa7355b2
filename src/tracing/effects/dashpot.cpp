#include "common/line_effect.h"

namespace knee_robot::tracing {
namespace {

/// A damper between a point of the base and a point of the platform: force c |v|^exponent against the rate v of their
/// distance.
class Dashpot : public LineDamper {
 public:
  std::string name() const override { return "dashpot"; }
  std::string sentence() const override {
    return "A damper, or a rubbing part, acts between a point of the base and a point of the platform: its force "
           "follows a power of "
           "the rate at which their distance changes.";
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"damping_N_per_speed_power", true}};
  }

 protected:
  Eigen::MatrixXd resistance(const Line& line, const std::vector<double>& shape) const override {
    return powerOfRate(line, shape);
  }
};

}  // namespace

std::unique_ptr<Candidate> makeDashpot() {
  return std::make_unique<Dashpot>();
}

}  // namespace knee_robot::tracing
