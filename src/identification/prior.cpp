#include "knee_robot/identification/prior.h"

#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/identification/physical_problem.h"

namespace knee_robot::identification {
namespace {

constexpr double kOffsetShare = 0.1;
constexpr double kLink_kg = 5.0, kPlatform_kg = 10.0, kGyration_m = 0.2;

dynamics::RobotInertia bodiesWithoutUrdf() {
  dynamics::RobotInertia inertia;
  for (int link = 0; link < dynamics::kLinks; ++link) {
    dynamics::LinkInertia& body = inertia.links[static_cast<std::size_t>(link)];
    body.mass = link == dynamics::kPlatformLink ? kPlatform_kg : kLink_kg;
    body.center.setZero();
    body.inertia = body.mass * kGyration_m * kGyration_m * mechanism::Matrix3::Identity();
  }
  return inertia;
}

}  // namespace

Prior priorOf(const mechanism::Robot& robot, const std::vector<Column>& columns, const Eigen::VectorXd& force_rms_N) {
  const Eigen::Index size = static_cast<Eigen::Index>(columns.size());
  const Eigen::Index rigid = robot.mechanism ? dynamics::kInertialParameters : 0;
  Prior prior;
  prior.mean = Eigen::VectorXd::Zero(size);
  prior.transform = Eigen::MatrixXd::Zero(size, rigid + robot.axes());
  if (robot.mechanism) {
    const PhysicalCoordinates bodies =
        physicalCoordinates(robot.urdf.empty() ? bodiesWithoutUrdf() : dynamics::loadRobotInertia(robot));
    prior.mean.head(rigid) = bodies.prior;
    prior.transform.topLeftCorner(rigid, rigid) = bodies.transform;
  }
  for (Eigen::Index c = 0; c < size; ++c) {
    const Column& column = columns[static_cast<std::size_t>(c)];
    if (column.role != ColumnRole::Offset) continue;
    prior.transform(c, rigid + column.actuator) = kOffsetShare * force_rms_N[column.actuator] + 1e-9;
  }
  return prior;
}

}  // namespace knee_robot::identification
