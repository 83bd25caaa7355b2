#include "knee_robot/identification/motion_path.h"

#include <cmath>
#include <limits>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::identification {

mechanism::Vector4 actuatorRow(const Eigen::MatrixXd& values, int sample) {
  mechanism::Vector4 row = mechanism::Vector4::Zero();
  row.head(values.cols()) = values.row(sample).transpose();
  return row;
}

MotionPath followPath(const mechanism::Robot& robot, const recording::Signals& signals) {
  MotionPath path;
  const std::size_t n = static_cast<std::size_t>(signals.samples());
  path.pose_known.assign(n, 1);
  path.condition.assign(n, 1.0);
  if (!robot.mechanism) return path;

  path.motion.resize(n);
  mechanism::Motion last;
  bool have_last = false;
  std::size_t lost = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const int sample = static_cast<int>(i);
    const mechanism::Lengths lengths = actuatorRow(signals.position_m, sample);
    mechanism::Pose guess = last.pose;
    bool ok = have_last;
    if (!have_last) {
      const mechanism::ForwardResult home = mechanism::forwardKinematicsFromHome(*robot.mechanism, lengths);
      ok = home.ok();
      guess = home.pose;
    }
    ok = ok && mechanism::motionFromLengths(*robot.mechanism, lengths, actuatorRow(signals.velocity_m_per_s, sample),
                                            actuatorRow(signals.acceleration_m_per_s2, sample), guess,
                                            path.motion[i]) == mechanism::ForwardStatus::Converged;
    if (ok) {
      last = path.motion[i];
      have_last = true;
      path.condition[i] = mechanism::conditionNumber(*robot.mechanism, last.pose);
      continue;
    }
    ++lost;
    path.motion[i] = last;
    path.motion[i].pose_velocity.setZero();
    path.motion[i].pose_acceleration.setZero();
    path.pose_known[i] = 0;
    path.condition[i] = std::numeric_limits<double>::infinity();
  }
  if (lost == n) {
    throw Refusal("the geometry of " + robot.path + " reaches none of the recorded lengths (first: " +
                  shortNumber(std::round(1e6 * signals.position_m(0, 0)) / 1e6) +
                  " m for actuator 1); is this recording from that robot?");
  }
  return path;
}

}  // namespace knee_robot::identification
