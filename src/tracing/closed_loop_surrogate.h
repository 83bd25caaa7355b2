#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "knee_robot/tracing/base_fit.h"

namespace knee_robot::tracing {

/// Controller of one axis as far as a recording shows it: force = kp e + ki int(e) + kd de/dt + share of the load fed
/// forward.
struct AxisController {
  double kp = 0.0, ki = 0.0, kd = 0.0;  ///< N/m, N/(m s), N s/m
  bool recovered = false;               ///< false: unknown, the surrogate follows the measured motion
  bool feeds_load_forward = false;
};

/// What a clean surrogate of one recording is made from: the fitted model along the measured motion, and the axes'
/// controllers.
struct SurrogatePlan {
  Eigen::MatrixXd load_N;   ///< samples x axes: rigid forces and offset without the axis' own effective mass
  Eigen::VectorXd mass_kg;  ///< effective mass of each axis
  Eigen::VectorXd viscous;  ///< N s/m
  Eigen::MatrixXd level_N;  ///< samples x axes: of dry friction, with what effects found so far make of it
  std::vector<AxisController> controllers;
  Eigen::MatrixXd model_N;      ///< samples x axes: the whole fitted model along the measured motion
  std::vector<char> open_loop;  ///< per axis: along the measured motion, because in closed loop it would leave too much
  std::vector<char> sticks_too_much;  ///< per axis: in closed loop it would stand still where the machine does not
  std::string note;                   ///< what was recovered and what was assumed, for the report
};

/// Recovers the controllers by least squares of the recorded force on the tracking error; where that explains less than
/// nine tenths, the axis' surrogate goes along the measured motion.
SurrogatePlan planSurrogate(const mechanism::Robot& robot, const recording::Recording& recording,
                            const identification::Observation& observation, const BaseFit& base);

/// Axes whose surrogate leaves much more than the recording itself (`left_N`, `real_N`: rms per axis), or stands still
/// where the machine does not, are not what it says they are (friction that stops them otherwise than stiction does):
/// their surrogates go along the measured motion from now on. Where most axes are not, none is believed: what an effect
/// leaves on the last one would pass for what its surrogate leaves. Returns a sentence for each axis whose loop was
/// opened.
std::vector<std::string> openLoops(const Eigen::VectorXd& left_N, const Eigen::VectorXd& real_N,
                                   std::vector<SurrogatePlan>& plans);

/// What effects found so far do along the measured motion, samples x axes, N.
struct SurrogateEffects {
  Eigen::MatrixXd friction_N;  ///< changes sign with the direction of travel
  Eigen::MatrixXd load_N;      ///< all others
  Eigen::MatrixXd drive_N;     ///< of those what lies in the drives (Candidate::ofDrive)
};

/// Puts the current model into a plan: `parameters` of the baseline, and effects (empty: none). A surrogate without an
/// effect that was found already would leave less at reversals than the recording does, and invent delays to mend that.
void refreshPlan(const identification::Observation& observation, const BaseFit& base, const Eigen::VectorXd& parameters,
                 const Eigen::MatrixXd& share, const SurrogateEffects& effects, SurrogatePlan& plan);

/// A recording as the fitted model would have left it: every axis a mass with stiction, Coulomb and viscous friction
/// that carries the load of the measured motion, in closed loop with its controller and the recorded reference, through
/// encoder (random phase), hold and DAC. Axes influence each other through the measured motion only.
recording::Recording simulateSurrogate(const mechanism::Robot& robot, const recording::Recording& recording,
                                       const identification::Observation& observation, const SurrogatePlan& plan,
                                       std::uint64_t seed);

}  // namespace knee_robot::tracing
