#include "knee_robot/identification/motion_path.h"

namespace knee_robot::identification {

mechanism::Vector4 actuatorRow(const Eigen::MatrixXd& values, int sample) {
  mechanism::Vector4 row = mechanism::Vector4::Zero();
  row.head(values.cols()) = values.row(sample).transpose();
  return row;
}

}  // namespace knee_robot::identification
