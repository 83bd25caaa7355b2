// {name: drive_lag, actuators: [4], time_constant_s: 0.004}
// The motors' forces follow their commands as a first-order lag (a slow current loop).
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class DriveLag : public EffectOf<DriveLag> {
 public:
  explicit DriveLag(StrictMap& entry)
      : actuators_(readActuators(entry)), time_constant_s_(entry.number("time_constant_s", 1e-5, 1.0)) {}
  void changeForce(double dt_s, mechanism::Vector4& motor_force) noexcept override {
    force_ += (1.0 - std::exp(-dt_s / time_constant_s_)) * (motor_force - force_);
    motor_force += actuators_.cwiseProduct(force_ - motor_force);
  }

 private:
  mechanism::Vector4 actuators_;
  double time_constant_s_;
  mechanism::Vector4 force_ = mechanism::Vector4::Zero();
};

}  // namespace

std::unique_ptr<Effect> makeDriveLag(StrictMap& entry) {
  return std::make_unique<DriveLag>(entry);
}

}  // namespace knee_robot::simulation
