#include <cmath>

#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// A spring in series with a damper. Its state is how far the spring is stretched, in m.
class ViscoelasticElement : public EffectLaw {
 public:
  explicit ViscoelasticElement(const Shape& shape) : lengthened_s_(shape[0]), shortened_s_(shape[1]) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  void columns(const EffectInstant& at, EffectState& state, EffectColumns& out) const noexcept override {
    const double relaxation_s = relaxation(state), keeps = std::exp(-at.period_s / relaxation_s);
    state.value = keeps * state.value + (1.0 - keeps) * relaxation_s * at.velocity_m_per_s[at.actuator];
    out[0] = state.value;
  }
  void rest(double duration_s, EffectState& state) const noexcept override {
    state.value *= std::exp(-duration_s / relaxation(state));
  }

 private:
  double relaxation(const EffectState& state) const noexcept {
    return state.value < 0.0 ? shortened_s_ : lengthened_s_;
  }

  const double lengthened_s_, shortened_s_;
};

}  // namespace

Law viscoelasticElementLaw(const Shape& shape) {
  if (!(shape[0] > 0.0 && shape[1] > 0.0)) return nullptr;  // it would grow by itself
  return std::make_unique<ViscoelasticElement>(shape);
}

}  // namespace knee_robot::dynamics
