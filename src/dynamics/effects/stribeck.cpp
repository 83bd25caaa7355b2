#include <cmath>

#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// Dry friction in excess at low velocity: share exp(-|v / v0|^exponent), exponent 2 where the file has none.
class Stribeck : public EffectLaw {
 public:
  explicit Stribeck(const Shape& shape) : velocity_m_per_s_(shape[0]), exponent_(shape.size() > 1 ? shape[1] : 2.0) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    const double ratio = std::abs(at.velocity_m_per_s[at.actuator] / velocity_m_per_s_);
    out[0] = at.share * std::exp(-std::pow(ratio, exponent_));
  }

 private:
  const double velocity_m_per_s_, exponent_;
};

}  // namespace

Law stribeckLaw(const Shape& shape) {
  return std::make_unique<Stribeck>(shape);
}

}  // namespace knee_robot::dynamics
