#include "joint_friction.h"

namespace knee_robot::dynamics {

Law platformJointFrictionLaw(const Shape& shape) {
  return std::make_unique<JointFriction>(platformJointColumns, kPlatformJointColumns, shape);
}

}  // namespace knee_robot::dynamics
