// {name: force_offset, actuators: [1], force_N: 4}
// The motor exerts this force more than commanded: an offset of the analog output or of the drive. It is gone
// when the drive is off.
#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class ForceOffset : public EffectOf<ForceOffset> {
 public:
  explicit ForceOffset(StrictMap& entry) : force_N_(entry.number("force_N", -1e3, 1e3) * readActuators(entry)) {}
  void changeForce(double /*dt_s*/, mechanism::Vector4& motor_force) noexcept override { motor_force += force_N_; }

 private:
  mechanism::Vector4 force_N_;
};

}  // namespace

std::unique_ptr<Effect> makeForceOffset(StrictMap& entry) {
  return std::make_unique<ForceOffset>(entry);
}

}  // namespace knee_robot::simulation
