#include <cmath>

#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// Viscous friction that grows with the axial force.
class LoadDependentViscous : public EffectLaw {
 public:
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    out[0] = at.velocity_m_per_s[at.actuator] * std::abs(at.load_N);
  }
};

}  // namespace

Law loadDependentViscousLaw(const Shape&) {
  return std::make_unique<LoadDependentViscous>();
}

}  // namespace knee_robot::dynamics
