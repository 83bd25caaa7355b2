#include <cmath>

#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// Dry friction by load and its square: the even coefficients while the motor drives the load, the odd ones while the
/// load drives it.
class PowerFlowFriction : public EffectLaw {
 public:
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  int coefficients() const noexcept override { return 4; }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    const double load = std::abs(at.load_N);
    const std::size_t driven = at.share * at.load_N < 0.0 ? 1 : 0;
    out[driven] = at.share * load;
    out[2 + driven] = at.share * load * load;
    out[1 - driven] = out[3 - driven] = 0.0;
  }
};

}  // namespace

Law powerFlowFrictionLaw(const Shape&) {
  return std::make_unique<PowerFlowFriction>();
}

}  // namespace knee_robot::dynamics
