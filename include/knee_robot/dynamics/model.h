#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "knee_robot/dynamics/acting_effects.h"
#include "knee_robot/dynamics/friction_law.h"
#include "knee_robot/dynamics/regressor.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::dynamics {

/// One column of the linear model. The values together are one representative of what the data determine: only the
/// combinations in Model::base have a meaning of their own where `verdict` is not "identified".
struct ModelParameter {
  std::string name;  ///< extendedParameterNames(); bench axes: axisParameterNames()
  std::string unit;
  double value = 0.0;
  double std = std::numeric_limits<double>::quiet_NaN();  ///< nan: the data do not determine this parameter alone
  std::string verdict = "not identifiable";  ///< identified, weakly identified, at its bound, not identifiable
};

/// A combination of parameters that the data determine: value = sum of weights * parameter. Parameters are in their
/// units; the weights bring all of them to newtons (column scaling).
struct BaseParameter {
  double value = 0.0;
  double std = 0.0;
  std::vector<double> weights;  ///< one per parameter of the model
};

/// A file that the model was fitted on.
struct ModelData {
  std::string file;
  std::string fingerprint;
  std::int64_t home_id = 0;  ///< of the recording (recording.h); 0: not known
};

/// A number of an effect.
struct EffectParameter {
  std::string name;  ///< with its unit
  double value = 0.0;
  double std = std::numeric_limits<double>::quiet_NaN();  ///< nan: searched on a grid
};

/// An effect beyond rigid body, Coulomb and viscous friction, as trace found it. Predicted along whole recordings by
/// predictModel (tracing/model_prediction.h), instant by instant by ForceModel (ActingEffects says which are).
struct ModelEffect {
  std::string name;            ///< of the list of effects, or "unnamed"
  std::string depends_on;      ///< signal of an unnamed one, otherwise empty
  std::vector<int> actuators;  ///< 1 .. axes
  bool transfers = true;       ///< false: belongs to one training recording
  std::vector<EffectParameter> shape;
  std::vector<EffectParameter> coefficients;
};

/// A model's numbers for recordings that it was not fitted on, where they differ: trace fits them without effects of
/// which it is not known what they depend on.
struct ModelElsewhere {
  std::vector<double> parameters;   ///< values, in the order of Model::parameters
  std::vector<double> effects_see;  ///< as Model::effects_see
  std::vector<ModelEffect> effects;
};

/// A model's numbers for a controller, where they differ: fitted without effects that no law gives it instant by instant
/// but that act on (a supply that sags), so that the parameters take up what they can of them.
struct ModelFeedforward {
  ModelElsewhere numbers;
  std::vector<FrictionLaw> friction;  ///< per actuator, chosen beside these effects
};

/// What a chain's model file says of a joint.
struct ModelJoint {
  std::string name;
  bool revolute = true;
  std::string force_unit;          ///< recorded and predicted: N, Nm or A
  double torque_per_ampere = 0.0;  ///< N m/A (prismatic: N/A); 0: not known, or nothing to convert
  double torque_per_ampere_std = 0.0;
};

/// Lowest and highest force (N, low-passed) of an actuator in the usable training samples.
struct TrainedForce {
  double low_N = 0.0, high_N = 0.0;
};

/// The identified force model of a robot: what `identify` and `trace` write, and what predictions and `trace` read.
struct Model {
  mechanism::MechanismKind kind = mechanism::MechanismKind::ThreeUpsOneRpu;
  int axes = 0;
  std::vector<ModelJoint> joints;  ///< of a chain, one an axis; otherwise empty
  bool in_joint_units = false;     ///< see inJointUnits
  std::string robot_fingerprint;   ///< of the robot file that it was identified with
  std::vector<ModelData> data;
  double cutoff_hz = 0.0;
  double motion_cutoff_hz = 0.0;      ///< low-pass of the positions from which rows are predicted; 0: that of the fit
  double fit_motion_cutoff_hz = 0.0;  ///< the same of the fit; 0: what follows from its cut-off and the encoders
  double fit_taut_steps = 0.0;        ///< of the fit: see identification::ObservationOptions::taut_steps
  double moving_m_per_s = 0.0;
  int rank = 0;                               ///< directions kept
  std::vector<FrictionLaw> friction;          ///< per actuator: how Coulomb friction acts near rest
  std::vector<double> residual_rms_N;         ///< per actuator, training data, moving samples
  std::vector<TrainedForce> trained_force_N;  ///< per actuator, of a robot with a platform; empty: not known
  std::vector<ModelParameter> parameters;
  std::vector<BaseParameter> base;
  std::vector<ModelEffect> effects;  ///< written by trace; none from identify
  // From trace only: predictions along whole recordings rest on them.
  /// Values of the parameters, in order, that the effects' columns were computed with (loads, friction): the last but
  /// one of the iterations between them and the fit.
  std::vector<double> effects_see;
  std::optional<ModelElsewhere> elsewhere;      ///< empty: the same everywhere
  std::optional<ModelFeedforward> feedforward;  ///< empty: as elsewhere
};

/// The numbers that count instant by instant, in a controller: those of its own, or those elsewhere. Null: the model has
/// one set.
const ModelElsewhere* numbersOfController(const Model& model);
const std::vector<ModelEffect>& effectsOfController(const Model& model);

/// Fv_1 Fc_1 rotor_1 offset_1 Fv_2 ...: the parameters of `axes` bench axes.
std::vector<std::string> axisParameterNames(int axes);

/// IXX_1 ... m_n of the bodies, then Fv_1 .., Fc_1 .., rotor_1 .., offset_1 ..: the parameters of a chain.
std::vector<std::string> chainParameterNames(int joints);

/// What the model file says of the robot's joints; empty unless it is a chain.
std::vector<ModelJoint> modelJoints(const mechanism::Robot& robot);

/// A chain's residuals and effects with their numbers in the joints' own units (N m, rad), as its file has them, or
/// back in metres and newtons. A model that is there already stays as it is.
Model inJointUnits(Model model);
Model fromJointUnits(Model model);

/// Writes and reads model files (YAML; format version 3, or 4 when trace wrote it; files of identify in version 1 are
/// read). Reading is strict: InputError with file, line and key.
std::string modelToYaml(const Model& model);
void saveModel(const Model& model, const std::string& path);
Model loadModel(const std::string& path);
Model parseModel(const std::string& text, const std::string& path);

/// InputError unless the model was identified with this robot file.
void requireModelOf(const Model& model, const std::string& model_path, const mechanism::Robot& robot);

/// The model as constants that forceFromModel needs. The model's numbers for a controller count where it has some, or
/// those elsewhere: what it is used for is none of its training recordings.
struct ForceModel {
  /// InputError when an effect is unknown or lacks its numbers.
  ForceModel(const Model& model, const mechanism::Robot& robot);

  std::optional<mechanism::Mechanism> mechanism;  ///< empty for bench axes
  mechanism::Vector3 gravity;
  int axes;
  ExtendedParameters parameters;       ///< of the parallel robot
  mechanism::Matrix4 axis_parameters;  ///< of bench axes: column i holds viscous, Coulomb, rotor, offset of axis i
  mechanism::Vector4 coulomb;          ///< N, taken out of `parameters`: it acts through the memory
  std::array<FrictionLaw, mechanism::kLegs> friction;  ///< per actuator
  ActingEffects effects;                               ///< and which are left out
};

/// Workspace of forceFromModel, and what remembers. One per motion.
struct ForceModelData {
  RegressorData regressor;
  ExtendedRegressor row;
  MotionMemory memory;
  mechanism::Vector4 last_position = mechanism::Vector4::Zero();
  bool started = false;
};

/// Actuator forces (N) for one instant of a motion: positions (m), velocities and accelerations of the actuators
/// (unused entries zero), and for the parallel robot the platform's motion that belongs to them (motionFromLengths).
/// Call it once per instant in order of time, `period_s` after the last one: friction and effects remember. What acts
/// later than it is asked for (delay, drive lag) is predicted: the force of that much later, on the motion as it goes
/// on from here with its acceleration and jerk. False, with `forces` untouched, where the mechanism is singular.
/// Real-time safe.
bool forceFromModel(const ForceModel& model, const mechanism::Vector4& position, const mechanism::Vector4& velocity,
                    const mechanism::Vector4& acceleration, const mechanism::Motion& motion, ForceModelData& data,
                    mechanism::Vector4& forces, double period_s = 0.01) noexcept;

}  // namespace knee_robot::dynamics
