#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// A constant force.
class ForceOffset : public EffectLaw {
 public:
  EffectPart part() const noexcept override { return EffectPart::Carried; }
  void columns(const EffectInstant&, EffectState&, EffectColumns& out) const noexcept override { out[0] = 1.0; }
};

}  // namespace

Law forceOffsetLaw(const Shape&) {
  return std::make_unique<ForceOffset>();
}

}  // namespace knee_robot::dynamics
