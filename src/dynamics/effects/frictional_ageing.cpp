#include <cmath>

#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// Dry friction that grows while the axis rests. Its state is how much of that a way has worn off: 0 aged, 1 worn.
class FrictionalAgeing : public EffectLaw {
 public:
  explicit FrictionalAgeing(const Shape& shape) : time_constant_s_(shape[0]), way_m_(shape[1]) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  void columns(const EffectInstant& at, EffectState& state, EffectColumns& out) const noexcept override {
    const double wears = std::abs(at.velocity_m_per_s[at.actuator]) / way_m_, rate = wears + 1.0 / time_constant_s_;
    state.value = wears / rate + (state.value - wears / rate) * std::exp(-rate * at.period_s);
    out[0] = (1.0 - state.value) * at.share;
  }
  void rest(double duration_s, EffectState& state) const noexcept override {
    state.value *= std::exp(-duration_s / time_constant_s_);
  }

 private:
  const double time_constant_s_, way_m_;
};

}  // namespace

Law frictionalAgeingLaw(const Shape& shape) {
  return std::make_unique<FrictionalAgeing>(shape);
}

}  // namespace knee_robot::dynamics
