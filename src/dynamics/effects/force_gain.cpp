#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// A wrong force constant: a share of the whole force.
class ForceGain : public EffectLaw {
 public:
  EffectPart part() const noexcept override { return EffectPart::Gain; }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    out[0] = at.force_N;
  }
};

}  // namespace

Law forceGainLaw(const Shape&) {
  return std::make_unique<ForceGain>();
}

}  // namespace knee_robot::dynamics
