// {name: drive_dead_zone, actuators: [2], lost_N: 4}
// The amplifier gives nothing for smaller commands, and less by as much for larger ones.
#include <algorithm>
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class DriveDeadZone : public EffectOf<DriveDeadZone> {
 public:
  explicit DriveDeadZone(StrictMap& entry) : lost_N_(entry.number("lost_N", 0.0, 1000.0) * readActuators(entry)) {}
  void changeForce(double /*dt_s*/, mechanism::Vector4& motor_force) noexcept override {
    for (Eigen::Index i = 0; i < motor_force.size(); ++i)
      motor_force[i] = std::copysign(std::max(0.0, std::abs(motor_force[i]) - lost_N_[i]), motor_force[i]);
  }

 private:
  mechanism::Vector4 lost_N_;
};

}  // namespace

std::unique_ptr<Effect> makeDriveDeadZone(StrictMap& entry) {
  return std::make_unique<DriveDeadZone>(entry);
}

}  // namespace knee_robot::simulation
