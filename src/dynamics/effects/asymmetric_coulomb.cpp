#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// Dry friction that differs by direction: half of the difference acts one way, whichever way it goes, as far as
/// friction has built up.
class AsymmetricCoulomb : public EffectLaw {
 public:
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    out[0] = at.share * at.share;
  }
};

}  // namespace

Law asymmetricCoulombLaw(const Shape&) {
  return std::make_unique<AsymmetricCoulomb>();
}

}  // namespace knee_robot::dynamics
