#include <cmath>

#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// Dry friction that grows with the axial force.
class LoadDependentFriction : public EffectLaw {
 public:
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    out[0] = at.share * std::abs(at.load_N);
  }
};

}  // namespace

Law loadDependentFrictionLaw(const Shape&) {
  return std::make_unique<LoadDependentFriction>();
}

}  // namespace knee_robot::dynamics
