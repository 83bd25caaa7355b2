#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <vector>

#include "knee_robot/trajectory/fourier_series.h"
#include "knee_robot/trajectory/reference_check.h"

namespace knee_robot {

/// How far the search is; for a line on a terminal.
struct ExcitationProgress {
  const char* stage = "";   ///< "random" or "improving"
  int done = 0, total = 0;  ///< random candidates, or evaluations of all starts
  double best_k = 0.0;      ///< of the best feasible series so far
};

struct ExcitationOptions {
  SeriesShape shape;                    ///< harmonics, duration, ramps; the period is what remains between the ramps
  unsigned seed = 1;                    ///< same seed and options, same plan (unless the budget cuts the search short)
  double velocity_max = 0.1;            ///< m/s, every actuator; the robot file's own limit holds too
  double acceleration_max = 1.0;        ///< m/s^2
  std::optional<double> condition_max;  ///< of dq/dx; default: planningCondition of the robot
  int directions = 56;           ///< r at which k = s_1 / s_r of the column-scaled observation matrix is minimised
  int candidates = 100;          ///< random feasible series to start with
  int starts = 4;                ///< the best of them are improved
  int iterations = 60;           ///< of each start, in each of three rounds
  double seconds_budget = 60.0;  ///< then the best so far is returned
  bool twin_legs = false;        ///< q23 and q33 identical, as in the paper's verification (sect. 2.1.5)
  std::function<void(const ExcitationProgress&)> progress;  ///< called from several threads, one at a time
  const std::atomic<bool>* interrupted = nullptr;           ///< set: stop and return the best so far
};

/// Condition numbers of the observation matrix at a number of directions; infinite when the data support fewer.
struct ConditionAt {
  int directions = 0;
  double scaled = 0.0;  ///< columns scaled to unit norm
  double raw = 0.0;     ///< SI units as they are
};

struct ExcitationPlan {
  FourierSeries series;
  Reference reference;  ///< actuator lengths, checked: it may be played
  ReferenceCheck check;
  std::vector<ConditionAt> conditions;  ///< at r = 20, 30, 40, 51, 56, 73
  double k = 0.0;                       ///< at the stated directions, scaled
  double random_k = 0.0;                ///< the best of the random candidates'
  int feasible_candidates = 0;
  int evaluations = 0;     ///< of k with its gradient
  bool cut_short = false;  ///< by the budget or by interruption
};

/// Plans an excitation: a finite Fourier series per actuator that is periodic, starts and ends at rest through smooth ramps and
/// keeps all limits of the robot and of the options (lengths, velocity, acceleration, joint angles, singularity margin).
/// Minimises k = s_1 / s_r of the column-scaled paper's K* (112 columns: rigid body and friction, eq. (28)) stacked over ten
/// instants a second. Random feasible series first; then L-BFGS on log k with a quadratic penalty on limits, over the
/// coefficients expressed through dq/dx at the centre (a unit of every variable then moves the pose by a similar amount; in
/// plain actuator coordinates one direction is twenty times as touchy as the others). Gradients: exact chain rule down to the
/// instant, central differences of the regressor at the instant.
/// InputError: options out of range, or a robot without a platform. Refusal: no pose has room for any motion.
ExcitationPlan planExcitation(const Robot& robot, const ExcitationOptions& options = {});

}  // namespace knee_robot
