#include "knee_robot/identification/prior.h"

#include "knee_robot/identification/motion_model.h"

namespace knee_robot::identification {
namespace {

constexpr double kLargestChangeOfUrdf = 2.0;  ///< in units of the prior: three times what was drawn

}  // namespace

Prior priorOf(const mechanism::Robot& robot, const std::vector<Column>& columns, const Eigen::VectorXd& force_rms_N) {
  const Eigen::Index size = static_cast<Eigen::Index>(columns.size());
  const PhysicalCoordinates bodies = motionModelOf(robot)->bodies();
  const Eigen::Index rigid = bodies.prior.size();
  Prior prior;
  prior.mean = Eigen::VectorXd::Zero(size);
  prior.transform = Eigen::MatrixXd::Zero(size, rigid + robot.axes());
  if (!robot.chain && !robot.urdf.empty()) {  // the platform is the last body, and carries what it carries
    prior.links = static_cast<int>(rigid) - PhysicalCoordinates::kPerLink;
    prior.largest_change = kLargestChangeOfUrdf;
  }
  prior.mean.head(rigid) = bodies.prior;
  prior.transform.topLeftCorner(rigid, rigid) = bodies.transform;
  for (Eigen::Index c = 0; c < size; ++c) {
    const Column& column = columns[static_cast<std::size_t>(c)];
    if (column.role != ColumnRole::Offset) continue;
    prior.transform(c, rigid + column.actuator) = (kOffsetShare * force_rms_N[column.actuator] + 1e-9) / column.newtons;
  }
  return prior;
}

}  // namespace knee_robot::identification
