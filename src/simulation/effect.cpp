#include "knee_robot/simulation/effect.h"

#include <Eigen/Geometry>
#include <cmath>

namespace knee_robot::simulation {

std::vector<std::string> effectNames() {
  std::vector<std::string> names;
  for (const NamedEffectMaker& maker : effectMakers())
    names.emplace_back(maker.name);
  return names;
}

std::shared_ptr<const Effect> readEffect(StrictMap& entry) {
  const std::string name = entry.choice("name", effectNames());
  for (const NamedEffectMaker& maker : effectMakers()) {
    if (name != maker.name) continue;
    std::shared_ptr<const Effect> effect = maker.make(entry);
    entry.finish();
    return effect;
  }
  entry.refuse("name", "there is no effect " + name);
}

mechanism::Vector4 readActuators(StrictMap& entry) {
  if (!entry.has("actuators")) return mechanism::Vector4::Ones();
  mechanism::Vector4 chosen = mechanism::Vector4::Zero();
  const std::vector<double> listed = entry.numbers("actuators", 0, 1.0, mechanism::kLegs);
  if (listed.empty()) entry.refuse("actuators", "is empty; list some of 1 to 4, or leave the key out for all of them");
  for (const double number : listed) {
    if (number != std::floor(number)) entry.refuse("actuators", "are whole numbers from 1 to 4");
    chosen[static_cast<Eigen::Index>(number) - 1] = 1.0;
  }
  return chosen;
}

mechanism::Vector3 readVector3(StrictMap& entry, const std::string& key, double minimum, double maximum) {
  const std::vector<double> v = entry.numbers(key, 3, minimum, maximum);
  return {v[0], v[1], v[2]};
}

mechanism::Vector4 poseForceOf(const mechanism::Pose& pose, const mechanism::Vector3& point,
                               const mechanism::Vector3& force) noexcept {
  const mechanism::Matrix3 rotation = mechanism::platformRotation(pose);
  const mechanism::Vector3 arm = rotation * point;
  const mechanism::Vector3 moment = arm.cross(force);
  return {force.x(), force.z(), moment.y(), moment.dot(rotation.col(2))};
}

mechanism::Vector3 platformPoint(const mechanism::Pose& pose, const mechanism::Vector3& point) noexcept {
  return mechanism::Vector3(pose[0], 0.0, pose[1]) + mechanism::platformRotation(pose) * point;
}

}  // namespace knee_robot::simulation
