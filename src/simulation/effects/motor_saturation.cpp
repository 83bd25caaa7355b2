// {name: motor_saturation, actuators: [4], lost_at_100_N: 0.1}
// The motor gives u (1 - lost |u| / 100 N) of a command u, and no more than the most that this ever is.
#include <algorithm>
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class MotorSaturation : public EffectOf<MotorSaturation> {
 public:
  explicit MotorSaturation(StrictMap& entry)
      : lost_per_N_(0.01 * entry.number("lost_at_100_N", 0.0, 1.0) * readActuators(entry)) {}
  void changeForce(double /*dt_s*/, mechanism::Vector4& motor_force) noexcept override {
    for (Eigen::Index i = 0; i < motor_force.size(); ++i) {
      if (lost_per_N_[i] <= 0.0) continue;
      const double told_N = std::min(std::abs(motor_force[i]), 0.5 / lost_per_N_[i]);
      motor_force[i] = std::copysign(told_N * (1.0 - lost_per_N_[i] * told_N), motor_force[i]);
    }
  }

 private:
  mechanism::Vector4 lost_per_N_;
};

}  // namespace

std::unique_ptr<Effect> makeMotorSaturation(StrictMap& entry) {
  return std::make_unique<MotorSaturation>(entry);
}

}  // namespace knee_robot::simulation
