#include "knee_robot/identification/motion_model.h"

namespace knee_robot::identification {

std::unique_ptr<MotionModel> motionModelOf(const mechanism::Robot& robot) {
  switch (robot.kind) {
    case mechanism::MechanismKind::Axes:
      return makeAxesModel(robot);
    case mechanism::MechanismKind::Chain:
      return makeChainModel(robot);
    default:
      return makeParallelModel(robot);
  }
}

}  // namespace knee_robot::identification
