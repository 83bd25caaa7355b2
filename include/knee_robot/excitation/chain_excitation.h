#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "knee_robot/excitation/fourier_series.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::excitation {

/// What a chain's excitation is planned for.
struct ChainExcitationOptions {
  SeriesShape shape;             ///< harmonics, duration, ramps; the period is what remains between the ramps
  unsigned seed = 1;             ///< same seed and options, same plan, unless the budget cuts the search short
  double share = 0.9;            ///< of every joint's range, velocity and acceleration limit that is used at most
  int candidates = 100;          ///< random series to start with
  double seconds_budget = 30.0;  ///< of the whole search, random series included; one of them is tried at least
  Eigen::MatrixXd
      units;  ///< rigid parameters of the chain per unit coordinate (see identification::MotionModel::bodies)
  Eigen::VectorXd noise;  ///< per joint, of the recorded torque, N m or N
  Eigen::MatrixXd known;  ///< information of what was already recorded, see chainInformation; empty: nothing was
};

/// How closely a plan comes to one joint's limits, shares.
struct JointUse {
  std::string name;
  double low = 0.0, high = 0.0;                            ///< rad or m
  double range = 0.0, velocity = 0.0, acceleration = 0.0;  ///< share of the limit
};

/// A motion of a chain that makes its model identifiable, beside what was recorded already.
struct ChainExcitationPlan {
  double period_s = 0.01;
  Eigen::MatrixXd position, velocity;  ///< samples x joints, rad or m
  std::vector<JointUse> joints;
  double information = 0.0;         ///< log determinant of 1 + information, with what was recorded
  double information_random = 0.0;  ///< of the best random series
  double information_known = 0.0;   ///< of what was recorded alone
  int decided_known = 0,
      decided = 0;  ///< directions with more information than the prior's: before, and with this motion
  int evaluations = 0;
};

/// Rows x (units, then viscous and dry friction and offset of every joint) of a motion's instants, each row over its
/// joint's noise: what the data say. Friction and offset count in tenths of what the noise would be a percent of.
/// Positions in rad or m, one row an instant.
Eigen::MatrixXd chainInformation(const mechanism::Robot& robot, const ChainExcitationOptions& options,
                                 const Eigen::MatrixXd& position, const Eigen::MatrixXd& velocity,
                                 const Eigen::MatrixXd& acceleration);

/// A finite Fourier series per joint within the robot file's limits, from rest to rest, that adds most to the logarithm
/// of the determinant of 1 + information (D-optimality beside the prior): what was recorded already counts. Random
/// series first, then NLopt's Sbplx from the best. Amplitude and centre of every joint follow from its limits, so that
/// every series that is tried keeps them; those of the plan are looked at every millisecond, ramps and ends included.
/// Knows of no obstacle and no self-collision. InputError when options are out of range.
ChainExcitationPlan planChainExcitation(const mechanism::Robot& robot, const ChainExcitationOptions& options);

}  // namespace knee_robot::excitation
