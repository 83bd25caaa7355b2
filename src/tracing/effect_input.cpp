#include "knee_robot/tracing/effect_input.h"

#include <Eigen/LU>
#include <algorithm>

#include "knee_robot/dynamics/acting_effects.h"
#include "knee_robot/dynamics/chain_regressor.h"
#include "knee_robot/dynamics/regressor.h"
#include "knee_robot/mechanism/kinematics.h"
#include "length_response.h"
#include "place_age.h"

namespace knee_robot::tracing {
namespace {

constexpr int kMassSamples = 12;
constexpr double kTurnCounts = 2.0;  ///< a smaller way back is the encoder's flicker, no reversal

void setSinceReversal(EffectInput& in, int actuator, double turn_m) {
  dynamics::ReversalTracker path;
  for (int n = 0; n < in.samples(); ++n) {
    const double step_m = n > 0 ? in.friction_position_m(n, actuator) - in.friction_position_m(n - 1, actuator) : 0.0;
    const dynamics::SinceReversal since = path.step(step_m, n > 0 ? in.signals().period_s : 0.0, turn_m);
    in.since_reversal_m(n, actuator) = since.way_m;
    in.since_reversal_s(n, actuator) = since.time_s;
    in.since_last_reversal_m(n, actuator) = since.way_of_last_m;
    if (since.turned) in.first_turn[actuator] = std::min(in.first_turn[actuator], n);
  }
}

std::vector<mechanism::Matrix4> poseForces(const mechanism::Robot& robot, const identification::Observation& o) {
  std::vector<mechanism::Matrix4> out;
  mechanism::Matrix4 last = mechanism::Matrix4::Zero();
  for (int n = 0; n < o.samples(); ++n) {
    const std::size_t i = static_cast<std::size_t>(n);
    if (o.motion.pose_known[i]) {
      const mechanism::Matrix4 inverse = mechanism::lengthJacobian(*robot.mechanism, o.motion.motion[i].pose).inverse();
      if (inverse.allFinite()) last = inverse.transpose();
    }
    out.push_back(last);
  }
  return out;
}

/// What many hypotheses ask of the pose.
void setPoses(EffectInput& in) {
  in.leg_angle_rad.resize(in.samples(), 2 * mechanism::kLegs);
  in.passive_joints.resize(static_cast<std::size_t>(in.samples()));
  for (int n = 0; n < in.samples(); ++n) {
    const std::size_t sample = static_cast<std::size_t>(n);
    const mechanism::Motion& motion = in.observation->motion.motion[sample];
    const mechanism::Pose& pose = motion.pose;
    dynamics::passiveJoints(*in.robot->mechanism, motion, in.passive_joints[sample]);
    in.rotation.push_back(mechanism::platformRotation(pose));
    const mechanism::JointCoordinates q = mechanism::inverseKinematics(*in.robot->mechanism, pose);
    for (std::size_t leg = 0; leg < q.q1.size(); ++leg)
      in.leg_angle_rad.row(n).segment<2>(2 * static_cast<Eigen::Index>(leg)) << q.q1[leg], q.q2[leg];
    in.leg_angle_rad.row(n).tail<2>().setConstant(q.q41);
  }
}

/// The same of a chain.
Eigen::VectorXd movedByJoints(const EffectInput& in, const Eigen::VectorXd& parameters) {
  const mechanism::Chain& chain = *in.robot->chain;
  const Eigen::Index rigid = chain.size() * dynamics::kLinkParameters;
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(in.axes()), per_m(in.axes());
  for (int i = 0; i < in.axes(); ++i)
    per_m[i] = in.robot->actuators[static_cast<std::size_t>(i)].position_per_m();
  dynamics::ChainRegressorData data(chain);
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(in.axes());
  for (int k = 0; k < kMassSamples; ++k) {
    const int n = (2 * k + 1) * in.samples() / (2 * kMassSamples);
    const Eigen::VectorXd q = in.signals().position_m.row(n).transpose().cwiseProduct(per_m);
    for (int i = 0; i < in.axes(); ++i) {
      const Eigen::VectorXd pushed = per_m[i] * Eigen::VectorXd::Unit(in.axes(), i);
      dynamics::chainRegressor(chain, mechanism::Vector3::Zero(), q, still, pushed, data);
      mass[i] += per_m[i] * data.regressor.row(i).dot(parameters.head(rigid));
    }
  }
  return (mass / kMassSamples).cwiseMax(0.0);
}

/// Mass that each actuator moves beyond its own rotor: the model's force for one more m/s^2 of that actuator alone.
Eigen::VectorXd movedMass(const EffectInput& in, const Eigen::VectorXd& parameters) {
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(in.axes());
  if (in.robot->chain) return movedByJoints(in, parameters);
  if (!in.robot->mechanism) return mass;
  dynamics::RegressorData data;
  dynamics::ExtendedRegressor still = dynamics::ExtendedRegressor::Zero(), pushed = still;
  int counted = 0;
  for (int k = 0; k < kMassSamples; ++k) {
    const std::size_t n = static_cast<std::size_t>((2 * k + 1) * in.samples() / (2 * kMassSamples));
    if (!in.observation->usable[n]) continue;
    mechanism::Motion motion = in.observation->motion.motion[n];
    if (!dynamics::extendedRegressor(*in.robot->mechanism, in.robot->gravity, motion, data, still)) continue;
    ++counted;
    for (int i = 0; i < in.axes(); ++i) {
      motion.pose_acceleration =
          in.observation->motion.motion[n].pose_acceleration + in.force_per_pose_force[n].row(i).transpose();
      dynamics::extendedRegressor(*in.robot->mechanism, in.robot->gravity, motion, data, pushed);
      mass[i] += (pushed - still)
                     .row(i)
                     .head(dynamics::kInertialParameters)
                     .dot(parameters.head(dynamics::kInertialParameters));
    }
  }
  return (mass / std::max(1, counted)).cwiseMax(0.0);
}

}  // namespace

EffectInput effectInput(const mechanism::Robot& robot, const identification::Observation& o,
                        const std::vector<dynamics::FrictionLaw>& laws, int recording, int recordings) {
  EffectInput in;
  in.robot = &robot;
  in.observation = &o;
  in.recording = recording;
  in.recordings = recordings;
  in.friction_position_m.resize(o.samples(), o.axes());
  in.share.resize(o.samples(), o.axes());
  in.since_reversal_m.resize(o.samples(), o.axes());
  in.since_reversal_s.resize(o.samples(), o.axes());
  in.since_last_reversal_m.resize(o.samples(), o.axes());
  in.first_turn = Eigen::VectorXi::Constant(o.axes(), o.samples());
  in.place_age_s.resize(o.samples(), o.axes());
  for (int i = 0; i < o.axes(); ++i) {
    const std::size_t axis = static_cast<std::size_t>(i);
    const identification::SlidingPath& path = o.sliding[axis];
    for (int n = 0; n < o.samples(); ++n)
      in.friction_position_m(n, i) = path.position[n * identification::SlidingPath::kSubsteps];
    in.laws.push_back(laws[axis]);
    in.share.col(i) = identification::frictionShare(path, laws[axis]);
    in.place_age_s.col(i) = placeAge(in.friction_position_m.col(i), o.signals.period_s);
    setSinceReversal(in, i, kTurnCounts * robot.actuators[axis].metresPerCount());
  }
  if (robot.mechanism) {
    in.force_per_pose_force = poseForces(robot, o);
    setPoses(in);
  }
  in.load_N = in.model_N = in.force_N = in.needed_N = Eigen::MatrixXd::Zero(o.samples(), o.axes());
  in.ahead_s = Eigen::VectorXd::Zero(o.axes());
  return in;
}

void setModel(EffectInput& in, const std::vector<identification::Column>& columns, const Eigen::VectorXd& parameters) {
  Eigen::VectorXd carried = parameters, rubs = Eigen::VectorXd::Zero(parameters.size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].isFriction()) std::swap(carried[static_cast<Eigen::Index>(c)], rubs[static_cast<Eigen::Index>(c)]);
  }
  for (int i = 0; i < in.axes(); ++i) {
    const Eigen::MatrixXd& regressor = in.observation->regressor[static_cast<std::size_t>(i)];
    in.load_N.col(i) = regressor * carried;
    in.model_N.col(i) = in.load_N.col(i);
    for (Eigen::Index c = 0; c < rubs.size(); ++c) {
      if (rubs[c] != 0.0) in.model_N.col(i) += rubs[c] * regressor.col(c);
    }
  }
  in.coulomb_N = in.viscous = in.rotor_kg = Eigen::VectorXd::Zero(in.axes());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const double value = parameters[static_cast<Eigen::Index>(c)] * columns[c].newtons;
    if (columns[c].role == identification::ColumnRole::Coulomb) in.coulomb_N[columns[c].actuator] = value;
    if (columns[c].role == identification::ColumnRole::Viscous) in.viscous[columns[c].actuator] = value;
    if (columns[c].role == identification::ColumnRole::Rotor) in.rotor_kg[columns[c].actuator] = value;
  }
  if (in.robot->mechanism) {
    in.inertial = parameters.head(dynamics::kInertialParameters);
    in.by_lengths = std::make_shared<LengthResponse>();
  }
  in.moved_kg = movedMass(in, parameters);
  setEffects(in, {});
}

void setEffects(EffectInput& in, const Eigen::MatrixXd& effects_N, const Eigen::MatrixXd& drive_N) {
  in.force_N = in.model_N;
  if (effects_N.size() > 0) in.force_N += effects_N;
  in.needed_N = in.force_N;
  if (drive_N.size() > 0) in.needed_N -= drive_N;
}

}  // namespace knee_robot::tracing
