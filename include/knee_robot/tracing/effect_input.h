#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "knee_robot/dynamics/passive_joints.h"
#include "knee_robot/identification/observation.h"

namespace knee_robot::tracing {

class LengthResponse;

/// What a hypothesis may look at along one recording. Matrices have one row per sample of the grid and one column per
/// actuator; nothing is low-passed at the cut-off yet. Forces are the current model's, not the recorded ones.
struct EffectInput {
  const mechanism::Robot* robot = nullptr;
  const identification::Observation* observation = nullptr;
  std::vector<dynamics::FrictionLaw> laws;  ///< near rest, per actuator
  Eigen::MatrixXd share;  ///< of full Coulomb friction, in [-1, 1], by the law that was chosen for the actuator
  Eigen::MatrixXd friction_position_m;  ///< without ways back that the encoder does not tell
  Eigen::MatrixXd load_N;    ///< rigid body, rotor and offset: what the screw carries, without the actuator's friction
  Eigen::MatrixXd model_N;   ///< of the current linear model, without effects
  Eigen::MatrixXd force_N;   ///< the whole current model
  Eigen::MatrixXd needed_N;  ///< the same without what lies in the drives (Candidate::ofDrive)
  Eigen::VectorXd ahead_s;   ///< per actuator, by which the current model's command runs ahead of it
  Eigen::VectorXd coulomb_N, viscous, rotor_kg;  ///< per actuator, of the current model
  Eigen::VectorXd
      inertial;  ///< inertial parameters of the current model (dynamics/parameters.h); bench and chain: empty
  std::shared_ptr<LengthResponse> by_lengths;  ///< of the current model; bench and chain: null
  Eigen::VectorXd moved_kg;  ///< per actuator: what its screw moves, without the rotor (mean over the recording)
  Eigen::MatrixXd since_reversal_m;       ///< see dynamics::SinceReversal
  Eigen::MatrixXd since_reversal_s;       ///< time since the path turned last
  Eigen::MatrixXd since_last_reversal_m;  ///< way since then, whatever loops it has closed
  Eigen::VectorXi first_turn;             ///< per actuator: sample from which its path has turned; samples(): never
  Eigen::MatrixXd place_age_s;            ///< see placeAge
  std::vector<mechanism::Matrix4>
      force_per_pose_force;  ///< J^-T per sample: actuator forces that balance a pose force; bench: empty
  std::vector<mechanism::Matrix3> rotation;             ///< of the platform, per sample; bench: empty
  std::vector<dynamics::PassiveJoints> passive_joints;  ///< per sample; bench: empty
  Eigen::MatrixXd leg_angle_rad;  ///< samples x 8: q1 and q2 of legs 1 to 3, q41 twice; bench: empty
  int recording = 0;              ///< index among the training recordings; -1: none of them
  int recordings = 1;             ///< number of training recordings

  int samples() const { return observation->samples(); }
  int axes() const { return observation->axes(); }
  const recording::Signals& signals() const { return observation->signals; }
  double time(int sample) const {
    return signals().time_s[static_cast<std::size_t>(sample)] - signals().time_s.front();
  }
};

/// What does not depend on the model's parameters; forces are zero until setModel.
EffectInput effectInput(const mechanism::Robot& robot, const identification::Observation& observation,
                        const std::vector<dynamics::FrictionLaw>& laws, int recording, int recordings);

/// Forces of a linear model along the recording, of which the platform and the axes make others; no effects.
void setModel(EffectInput& input, const std::vector<identification::Column>& columns,
              const Eigen::VectorXd& parameters);
/// `effects_N` (samples x axes, may be empty) are the forces of effects found so far beside that model, `drive_N` those
/// of them that lie in the drives.
void setEffects(EffectInput& input, const Eigen::MatrixXd& effects_N, const Eigen::MatrixXd& drive_N = {});

}  // namespace knee_robot::tracing
