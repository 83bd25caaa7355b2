#include <cmath>

#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// Friction that changes as the drive warms up. Its state is how warm it is: 0 cold, 1 for good.
class ThermalDrift : public EffectLaw {
 public:
  explicit ThermalDrift(const Shape& shape) : time_constant_s_(shape[0]) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  int coefficients() const noexcept override { return 2; }
  void columns(const EffectInstant& at, EffectState& state, EffectColumns& out) const noexcept override {
    state.value += (1.0 - state.value) * -std::expm1(-at.period_s / time_constant_s_);
    out[0] = state.value * at.share;
    out[1] = state.value * at.velocity_m_per_s[at.actuator];
  }
  void rest(double duration_s, EffectState& state) const noexcept override {
    state.value *= std::exp(-duration_s / time_constant_s_);
  }

 private:
  const double time_constant_s_;
};

}  // namespace

Law thermalDriftLaw(const Shape& shape) {
  return std::make_unique<ThermalDrift>(shape);
}

}  // namespace knee_robot::dynamics
