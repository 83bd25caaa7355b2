#include "force_model_prediction.h"

#include "knee_robot/identification/sliding_path.h"
#include "knee_robot/identification/trained_range.h"

namespace knee_robot::identification {
namespace {

/// Takes the passive joints' Coulomb friction out of the model: it acts along their sliding paths.
Eigen::Matrix<double, PassiveCoulomb::kJoints, 1> takePassiveCoulomb(dynamics::ForceModel& model) {
  Eigen::Matrix<double, PassiveCoulomb::kJoints, 1> friction;
  for (int joint = 0; joint < PassiveCoulomb::kJoints; ++joint) {
    double& parameter = model.parameters[dynamics::extended::kPassiveFriction + 2 * joint + 1];
    friction[joint] = parameter;
    parameter = 0.0;
  }
  return friction;
}

/// Coulomb friction along the whole motion, as identification takes it: with its reversals found in both directions of
/// time.
PredictedForce coulombForces(dynamics::ForceModel& model, const mechanism::Robot& robot, const recording::Signals& s,
                             const MotionPath& path) {
  PredictedForce forces{Eigen::MatrixXd(s.samples(), robot.axes()), Eigen::MatrixXd(s.samples(), robot.axes())};
  const std::vector<SlidingPath> sliding = actuatorPaths(robot, s);
  for (int i = 0; i < robot.axes(); ++i) {
    const std::size_t axis = static_cast<std::size_t>(i);
    forces.mean_N.col(i) = model.coulomb[i] * frictionShare(sliding[axis], model.friction[axis]);
    forces.at_sample_N.col(i) = model.coulomb[i] * shareAtSamples(sliding[axis], model.friction[axis]);
  }
  model.coulomb.setZero();
  if (!model.mechanism) return forces;
  const auto friction = takePassiveCoulomb(model);
  if (friction.isZero(0.0)) return forces;
  const PassiveCoulomb passive(robot, s, path);
  for (int n = 0; n < s.samples(); ++n) {
    for (int joint = 0; joint < PassiveCoulomb::kJoints; ++joint) {
      forces.mean_N.row(n) += friction[joint] * passive.column(n, joint).transpose();
      forces.at_sample_N.row(n) += friction[joint] * passive.column(n, joint).transpose();
    }
  }
  return forces;
}

}  // namespace

PredictedForce predictByForceModel(const dynamics::Model& model, const mechanism::Robot& robot,
                                   const recording::Signals& s, const MotionPath& path) {
  dynamics::ForceModel force_model(model, robot);
  PredictedForce force = coulombForces(force_model, robot, s, path);
  dynamics::ForceModelData data;
  Eigen::MatrixXd out(s.samples(), robot.axes());
  mechanism::Vector4 forces = mechanism::Vector4::Zero();
  int first_known = -1;
  for (int n = 0; n < s.samples(); ++n) {
    const std::size_t i = static_cast<std::size_t>(n);
    const mechanism::Motion motion = path.motion.empty() ? mechanism::Motion() : path.motion[i];
    if (path.pose_known[i]) {
      mechanism::Vector4 here;
      const bool ok =
          dynamics::forceFromModel(force_model, actuatorRow(s.position_m, n), actuatorRow(s.velocity_m_per_s, n),
                                   actuatorRow(s.acceleration_m_per_s2, n), motion, data, here);
      if (ok && here.allFinite()) {
        forces = here;
        if (first_known < 0) first_known = n;
      }
    }
    out.row(n) = forces.head(robot.axes()).transpose();
  }
  for (int n = 0; n < first_known; ++n)
    out.row(n) = out.row(first_known);
  force.mean_N += out;
  force.at_sample_N += out;
  keepWithinTrainedRange(model.trained_force_N, path, force.mean_N);
  keepWithinTrainedRange(model.trained_force_N, path, force.at_sample_N);
  return force;
}

}  // namespace knee_robot::identification
