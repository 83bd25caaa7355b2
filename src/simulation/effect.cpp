#include "knee_robot/simulation/effect.h"

#include <Eigen/Geometry>
#include <cmath>

namespace knee_robot {

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

Vector4 readActuators(StrictMap& entry) {
  if (!entry.has("actuators")) return Vector4::Ones();
  Vector4 chosen = Vector4::Zero();
  const std::vector<double> listed = entry.numbers("actuators", 0, 1.0, kLegs);
  if (listed.empty()) entry.refuse("actuators", "is empty; list some of 1 to 4, or leave the key out for all of them");
  for (const double number : listed) {
    if (number != std::floor(number)) entry.refuse("actuators", "are whole numbers from 1 to 4");
    chosen[static_cast<Eigen::Index>(number) - 1] = 1.0;
  }
  return chosen;
}

Vector3 readVector3(StrictMap& entry, const std::string& key, double minimum, double maximum) {
  const std::vector<double> v = entry.numbers(key, 3, minimum, maximum);
  return {v[0], v[1], v[2]};
}

Vector4 poseForceOf(const Pose& pose, const Vector3& point, const Vector3& force) noexcept {
  const Matrix3 rotation = platformRotation(pose);
  const Vector3 arm = rotation * point;
  const Vector3 moment = arm.cross(force);
  return {force.x(), force.z(), moment.y(), moment.dot(rotation.col(2))};
}

Vector3 platformPoint(const Pose& pose, const Vector3& point) noexcept {
  return Vector3(pose[0], 0.0, pose[1]) + platformRotation(pose) * point;
}

}  // namespace knee_robot
