// {name: force_gain, actuators: [3], factor: 0.93}
// The motor exerts another force per volt than the robot file says.
#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class ForceGain : public EffectOf<ForceGain> {
 public:
  explicit ForceGain(StrictMap& entry)
      : factor_(mechanism::Vector4::Ones() + (entry.number("factor", 0.0, 10.0) - 1.0) * readActuators(entry)) {}
  void changeForce(double /*dt_s*/, mechanism::Vector4& motor_force) noexcept override {
    motor_force = motor_force.cwiseProduct(factor_);
  }

 private:
  mechanism::Vector4 factor_;
};

}  // namespace

std::unique_ptr<Effect> makeForceGain(StrictMap& entry) {
  return std::make_unique<ForceGain>(entry);
}

}  // namespace knee_robot::simulation
