#include <cmath>

#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// Dahl's friction: builds up over a way after each reversal, ds/dx = (1 - s sign(dx)) / length.
class Presliding : public EffectLaw {
 public:
  explicit Presliding(const Shape& shape) : length_m_(shape[0]) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  void columns(const EffectInstant& at, EffectState& state, EffectColumns& out) const noexcept override {
    const double end = at.displacement_m >= 0.0 ? 1.0 : -1.0;
    const double remembered = at.fade * state.value;
    state.value = end - (end - remembered) * std::exp(-std::abs(at.displacement_m) / length_m_);
    out[0] = state.value;
  }

 private:
  const double length_m_;
};

}  // namespace

Law preslidingLaw(const Shape& shape) {
  return std::make_unique<Presliding>(shape);
}

}  // namespace knee_robot::dynamics
