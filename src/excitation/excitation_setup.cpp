#include "excitation_setup.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/trajectory/exercise_fit.h"

namespace knee_robot::excitation {
namespace {

constexpr double kLengthInset = 0.02;  ///< share of each actuator's range that is left unused at both ends
constexpr double kLimitInset = 0.98;   ///< share of the other limits that is used between the instants looked at
constexpr double kSignWidth = 0.02;    ///< of smoothed signs, as share of the velocity limit
constexpr double kRadius_m = 0.3;      ///< turns it into an angular velocity

void refuseOptions(const mechanism::Robot& robot, const ExcitationOptions& options) {
  const auto demand = [](bool holds, const std::string& sentence) {
    if (!holds) throw InputError(sentence);
  };
  demand(robot.kind == mechanism::MechanismKind::ThreeUpsOneRpu,
         robot.path + " describes separate axes; an excitation moves a platform");
  completedShape(options.shape);
  demand(options.velocity_max > 0.0 && options.velocity_max <= 1.0,
         "velocity " + shortNumber(options.velocity_max) + " is not in (0, 1] m/s");
  demand(options.acceleration_max > 0.0 && options.acceleration_max <= 100.0,
         "acceleration " + shortNumber(options.acceleration_max) + " is not in (0, 100] m/s2");
  demand(!options.condition_max || (*options.condition_max > 1.0 && *options.condition_max <= 1e6),
         "the singularity margin is not in (1, 1e6]");
  demand(
      options.directions >= 2 && options.directions <= 73,
      "directions " + std::to_string(options.directions) + " is not in 2 to 73, the rank of rich motion with friction");
  demand(options.candidates >= 2 && options.candidates <= 100000, "candidates are not in 2 to 100000");
  demand(options.starts >= 0 && options.starts <= options.candidates,
         "starts are not in 0 to the number of candidates");
  demand(!options.noise_N || (options.noise_N->minCoeff() > 0.0 && options.noise_N->allFinite()),
         "the noise of every actuator must be positive");
  demand(options.friction.viscous_N_s_per_m >= 0.0 && options.friction.coulomb_N >= 0.0,
         "the expected friction must not be negative");
  demand(options.iterations >= 1 && options.seconds_budget > 0.0, "iterations and budget must be positive");
}

/// The robot with the options' limits where they are stricter than its own.
mechanism::Robot limitedRobot(const mechanism::Robot& robot, const ExcitationOptions& options) {
  mechanism::Robot limited = robot;
  for (mechanism::Actuator& actuator : limited.actuators) {
    actuator.velocity_max_m_per_s = std::min(actuator.velocity_max_m_per_s, options.velocity_max);
    actuator.acceleration_max_m_per_s2 = std::min(actuator.acceleration_max_m_per_s2, options.acceleration_max);
  }
  limited.singularity_condition_max =
      std::min(robot.singularity_condition_max, options.condition_max.value_or(trajectory::planningCondition(robot)));
  return limited;
}

/// The limits that the search keeps at its instants, so that the real ones hold between them.
mechanism::Robot insetRobot(const mechanism::Robot& limited) {
  mechanism::Robot inset = limited;
  for (mechanism::Actuator& actuator : inset.actuators) {
    const double room = kLengthInset * (actuator.position_max_m - actuator.position_min_m);
    actuator.position_min_m += room;
    actuator.position_max_m -= room;
    actuator.velocity_max_m_per_s *= kLimitInset;
    actuator.acceleration_max_m_per_s2 *= kLimitInset;
    actuator.voltage_max_V *= kLimitInset;
    actuator.force_max_N *= kLimitInset;
    actuator.force_continuous_N *= kLimitInset;
  }
  inset.joints.spherical_max *= kLimitInset;
  inset.joints.universal_max *= kLimitInset;
  inset.joints.revolute_max *= kLimitInset;
  inset.singularity_condition_max *= kLimitInset;
  return inset;
}

/// The pose near `pose` at which legs 2 and 3 are equally long: Newton steps of least size, a radian counted as 1/3 m.
mechanism::Pose withTwinLengths(const mechanism::Mechanism& mechanism, mechanism::Pose pose) {
  const mechanism::Vector4 weight(1.0, 1.0, 9.0, 9.0);
  for (int round = 0; round < 20; ++round) {
    const mechanism::Lengths lengths = mechanism::legLengths(mechanism, pose);
    const mechanism::Matrix4 jacobian = mechanism::lengthJacobian(mechanism, pose);
    const mechanism::Vector4 slope = (jacobian.row(1) - jacobian.row(2)).transpose();
    pose -= (lengths[1] - lengths[2]) / slope.dot(weight.cwiseProduct(slope)) * weight.cwiseProduct(slope);
  }
  return pose;
}

ExcitationTask taskOf(const mechanism::Robot& inset, const ExcitationOptions& options) {
  ExcitationTask task;
  task.robot = inset;
  task.shape = completedShape(options.shape);
  task.directions = options.directions;
  task.criterion = options.criterion;
  task.twin_legs = options.twin_legs;
  if (options.force_limits) task.load = expectedLoad(inset, options.friction);
  // Noise of a drive grows with its force per volt; only the ratios matter.
  double fastest = 0.0;
  for (int i = 0; i < mechanism::kLegs; ++i) {
    task.noise_N[i] = std::abs(inset.actuators[i].force_per_volt_N);
    fastest = std::max(fastest, inset.actuators[i].velocity_max_m_per_s);
  }
  task.noise_N = options.noise_N.value_or(task.noise_N);
  task.noise_N /= task.noise_N.minCoeff();
  task.width = {kSignWidth * fastest, kSignWidth * fastest / kRadius_m};
  return task;
}

}  // namespace

ExcitationSetup setUpExcitation(const mechanism::Robot& robot, const ExcitationOptions& options) {
  refuseOptions(robot, options);
  const mechanism::Robot limited = limitedRobot(robot, options), inset = insetRobot(limited);
  const trajectory::Exercise standing{"excitation", "", false, 0.0, {}, std::nullopt};
  mechanism::Pose centre = trajectory::startThatFitsMost(standing, inset, 0.0);
  if (options.twin_legs) centre = withTwinLengths(*robot.mechanism, centre);
  const trajectory::Margin nearest = trajectory::nearestLimit(inset, centre, inset.singularity_condition_max);
  if (nearest.left <= 0.0) {
    throw Refusal("no pose of " + robot.path + " has room for motion: even the best one is beyond " +
                  trajectory::limitText(nearest));
  }
  return {limited, ExcitationProblem(taskOf(inset, options), centre)};
}

}  // namespace knee_robot::excitation
