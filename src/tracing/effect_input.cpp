#include "knee_robot/tracing/effect_input.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot {
namespace {

constexpr double kTurnCounts = 2.0;  ///< a smaller way back is the encoder's flicker, no reversal

Eigen::VectorXd sinceReversal(const Signals& s, int i, double flicker_m) {
  Eigen::VectorXd out(s.samples());
  double turn = s.position_m(0, i);
  double extreme = turn;
  double direction = 0.0;
  for (int n = 0; n < s.samples(); ++n) {
    const double q = s.position_m(n, i);
    if (direction == 0.0 && std::abs(q - turn) > flicker_m) direction = q > turn ? 1.0 : -1.0;
    if (direction * (q - extreme) > 0.0 || direction == 0.0) extreme = q;
    if (direction * (extreme - q) > flicker_m) {
      turn = extreme;
      direction = -direction;
      extreme = q;
    }
    out[n] = std::abs(q - turn);
  }
  return out;
}

std::vector<Matrix4> poseForces(const Robot& robot, const Observation& o) {
  std::vector<Matrix4> out;
  Matrix4 last = Matrix4::Zero();
  for (int n = 0; n < o.samples(); ++n) {
    const std::size_t i = static_cast<std::size_t>(n);
    if (o.motion.pose_known[i]) {
      const Matrix4 inverse = lengthJacobian(*robot.mechanism, o.motion.motion[i].pose).inverse();
      if (inverse.allFinite()) last = inverse.transpose();
    }
    out.push_back(last);
  }
  return out;
}

}  // namespace

EffectInput effectInput(const Robot& robot, const Observation& o, const std::vector<double>& widths, int recording,
                        int recordings) {
  EffectInput in;
  in.robot = &robot;
  in.observation = &o;
  in.recording = recording;
  in.recordings = recordings;
  in.share.resize(o.samples(), o.axes());
  in.since_reversal_m.resize(o.samples(), o.axes());
  for (int i = 0; i < o.axes(); ++i) {
    const std::size_t axis = static_cast<std::size_t>(i);
    in.share.col(i) = coulombShare(o.signals, i, widths[axis]);
    in.since_reversal_m.col(i) = sinceReversal(o.signals, i, kTurnCounts * robot.actuators[axis].metresPerCount());
  }
  if (robot.mechanism) in.force_per_pose_force = poseForces(robot, o);
  in.load_N = in.force_N = Eigen::MatrixXd::Zero(o.samples(), o.axes());
  return in;
}

void setForces(EffectInput& in, const std::vector<Column>& columns, const Eigen::VectorXd& parameters,
               const Eigen::MatrixXd& effects_N) {
  Eigen::VectorXd carried = parameters;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].isFriction()) carried[static_cast<Eigen::Index>(c)] = 0.0;
  }
  Eigen::MatrixXd both(parameters.size(), 2);
  both << carried, parameters;
  for (int i = 0; i < in.axes(); ++i) {
    const Eigen::MatrixXd forces = in.observation->regressor[static_cast<std::size_t>(i)] * both;
    in.load_N.col(i) = forces.col(0);
    in.force_N.col(i) = forces.col(1);
  }
  if (effects_N.size() > 0) in.force_N += effects_N;
}

}  // namespace knee_robot
