#include <cmath>

#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// Viscous friction that differs by direction.
class AsymmetricViscous : public EffectLaw {
 public:
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    out[0] = std::abs(at.velocity_m_per_s[at.actuator]);
  }
};

}  // namespace

Law asymmetricViscousLaw(const Shape&) {
  return std::make_unique<AsymmetricViscous>();
}

}  // namespace knee_robot::dynamics
