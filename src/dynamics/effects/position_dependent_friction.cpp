#include "knee_robot/dynamics/stroke_place.h"
#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// A place along the stroke where dry friction differs.
class PositionDependentFriction : public EffectLaw {
 public:
  explicit PositionDependentFriction(const Shape& shape) : place_(shape[0], shape[1], shape[2], shape[3]) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    out[0] = at.share * place_.at(at.position_m[at.actuator]);
  }

 private:
  const StrokePlace place_;
};

}  // namespace

Law positionDependentFrictionLaw(const Shape& shape) {
  return std::make_unique<PositionDependentFriction>(shape);
}

}  // namespace knee_robot::dynamics
