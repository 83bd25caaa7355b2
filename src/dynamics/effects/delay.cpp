#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// A force that acts later than it was asked for, by a dead time or a first-order lag: to first order both want the
/// force of that much later.
class Delay : public EffectLaw {
 public:
  EffectPart part() const noexcept override { return EffectPart::Ahead; }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    out[0] = at.force_rate_N_per_s;
  }
};

}  // namespace

Law delayLaw(const Shape&) {
  return std::make_unique<Delay>();
}

}  // namespace knee_robot::dynamics
