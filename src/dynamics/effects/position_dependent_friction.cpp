#include <algorithm>
#include <cmath>

#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// A place along the stroke where dry friction differs; beyond what training has seen it stays as at its end.
class PositionDependentFriction : public EffectLaw {
 public:
  explicit PositionDependentFriction(const Shape& shape)
      : center_m_(shape[0]), width_m_(shape[1]), from_m_(shape[2]), to_m_(std::max(shape[2], shape[3])) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    const double away = (std::clamp(at.position_m[at.actuator], from_m_, to_m_) - center_m_) / width_m_;
    out[0] = at.share * std::exp(-away * away);
  }

 private:
  const double center_m_, width_m_, from_m_, to_m_;
};

}  // namespace

Law positionDependentFrictionLaw(const Shape& shape) {
  return std::make_unique<PositionDependentFriction>(shape);
}

}  // namespace knee_robot::dynamics
