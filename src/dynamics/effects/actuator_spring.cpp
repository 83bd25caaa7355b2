#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// A force in proportion to the actuator's way from a position.
class ActuatorSpring : public EffectLaw {
 public:
  explicit ActuatorSpring(const Shape& shape) : zero_at_m_(shape[0]) {}
  EffectPart part() const noexcept override { return EffectPart::Carried; }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    out[0] = at.position_m[at.actuator] - zero_at_m_;
  }

 private:
  const double zero_at_m_;
};

}  // namespace

Law actuatorSpringLaw(const Shape& shape) {
  return std::make_unique<ActuatorSpring>(shape);
}

}  // namespace knee_robot::dynamics
