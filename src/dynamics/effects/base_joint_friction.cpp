#include "joint_friction.h"

namespace knee_robot::dynamics {

Law baseJointFrictionLaw(const Shape& shape) {
  return std::make_unique<JointFriction>(baseJointColumns, kBaseJointColumns, shape);
}

}  // namespace knee_robot::dynamics
