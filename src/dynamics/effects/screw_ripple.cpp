#include <cmath>

#include "common_phase.h"
#include "knee_robot/base/constants.h"
#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// Sine and cosine of the screw's turn: of the force, or of dry friction.
class ScrewRipple : public EffectLaw {
 public:
  explicit ScrewRipple(const Shape& shape) : turn_per_m_(kTwoPi / shape[0]), of_friction_(shape[1] > 0.5) {}
  EffectPart part() const noexcept override { return of_friction_ ? EffectPart::Friction : EffectPart::Carried; }
  int coefficients() const noexcept override { return 2; }
  std::vector<double> inOtherRecordings(std::vector<double> coefficients) const override {
    return commonPhase(coefficients);
  }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    const double phase = turn_per_m_ * at.position_m[at.actuator];
    const double factor = of_friction_ ? at.share : 1.0;
    out[0] = factor * std::sin(phase);
    out[1] = factor * std::cos(phase);
  }

 private:
  const double turn_per_m_;
  const bool of_friction_;
};

}  // namespace

Law screwRippleLaw(const Shape& shape) {
  return std::make_unique<ScrewRipple>(shape);
}

}  // namespace knee_robot::dynamics
