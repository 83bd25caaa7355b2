#include <cmath>

#include "common_phase.h"
#include "knee_robot/base/constants.h"
#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// Sine and cosine of the screw's turn, as a share of what the screw carries.
class LoadRipple : public EffectLaw {
 public:
  explicit LoadRipple(const Shape& shape) : turn_per_m_(kTwoPi / shape[0]) {}
  EffectPart part() const noexcept override { return EffectPart::Carried; }
  int coefficients() const noexcept override { return 2; }
  std::vector<double> inOtherRecordings(std::vector<double> coefficients) const override {
    return commonPhase(coefficients);
  }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    const double phase = turn_per_m_ * at.position_m[at.actuator];
    out[0] = at.load_N * std::sin(phase);
    out[1] = at.load_N * std::cos(phase);
  }

 private:
  const double turn_per_m_;
};

}  // namespace

Law loadRippleLaw(const Shape& shape) {
  return std::make_unique<LoadRipple>(shape);
}

}  // namespace knee_robot::dynamics
