#include "knee_robot/identification/motion_path.h"

#include "knee_robot/identification/motion_model.h"

namespace knee_robot::identification {

mechanism::Vector4 actuatorRow(const Eigen::MatrixXd& values, int sample) {
  mechanism::Vector4 row = mechanism::Vector4::Zero();
  row.head(values.cols()) = values.row(sample).transpose();
  return row;
}

MotionPath followPath(const mechanism::Robot& robot, const recording::Signals& signals) {
  return motionModelOf(robot)->follow(signals);
}

}  // namespace knee_robot::identification
