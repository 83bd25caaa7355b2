#include "knee_robot/dynamics/whirl.h"
#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// The drag of a screw near its critical speed.
class ScrewWhirl : public EffectLaw {
 public:
  explicit ScrewWhirl(const Whirl& whirl) : whirl_(whirl) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    out[0] = whirl_.share(at.position_m[at.actuator], at.velocity_m_per_s[at.actuator]);
  }

 private:
  const Whirl whirl_;
};

}  // namespace

Law screwWhirlLaw(const Shape& shape) {
  if (!(shape[1] > 0.0) || !(shape[2] > 0.0)) return nullptr;
  return std::make_unique<ScrewWhirl>(Whirl{shape[0], shape[1], shape[2]});
}

}  // namespace knee_robot::dynamics
