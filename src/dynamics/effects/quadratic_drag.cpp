#include <cmath>

#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// Friction that grows with the square of the velocity.
class QuadraticDrag : public EffectLaw {
 public:
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    const double v = at.velocity_m_per_s[at.actuator];
    out[0] = v * std::abs(v);
  }
};

}  // namespace

Law quadraticDragLaw(const Shape&) {
  return std::make_unique<QuadraticDrag>();
}

}  // namespace knee_robot::dynamics
