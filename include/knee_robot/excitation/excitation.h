#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <vector>

#include "knee_robot/excitation/excitation_limits.h"
#include "knee_robot/excitation/fourier_series.h"
#include "knee_robot/trajectory/reference_check.h"

namespace knee_robot::excitation {

/// How far the search is; for a line on a terminal.
struct ExcitationProgress {
  const char* stage = "";   ///< "random" or "improving"
  int done = 0, total = 0;  ///< random candidates, or evaluations of all starts
  double best = 0.0;        ///< of the feasible series so far: k, or 1 / geometric mean of the singular values
};

/// What is minimised, of the noise-weighted observation matrix W: K* (112 columns: rigid body and friction, eq. (28))
/// stacked over the instants, each row divided by its actuator's noise.
enum class ExcitationCriterion {
  Condition,    ///< k = s_1 / s_r with the columns scaled to unit norm
  Determinant,  ///< D-optimality: largest product of s_1 .. s_r, columns scaled by those of the first random series
};

/// What an excitation has to keep to, and how long to look for a good one.
struct ExcitationOptions {
  SeriesShape shape;                    ///< harmonics, duration, ramps; the period is what remains between the ramps
  unsigned seed = 1;                    ///< same seed and options, same plan (unless the budget cuts the search short)
  double velocity_max = 0.1;            ///< m/s, every actuator; the robot file's own limit holds too
  double acceleration_max = 1.0;        ///< m/s^2
  std::optional<double> condition_max;  ///< of dq/dx; default: planningCondition of the robot
  bool force_limits = true;             ///< keep the drives' forces (needs the robot's URDF; without one it cannot)
  ExpectedFriction friction;            ///< of the forces that are expected
  ExcitationCriterion criterion = ExcitationCriterion::Condition;
  int directions = 51;  ///< r; 51 is the rank of the rigid body in rich motion, 73 that with friction
  std::optional<mechanism::Vector4> noise_N;  ///< of the actuators' forces; default: in proportion to force_per_volt_N
  int candidates = 100;                       ///< random feasible series to start with
  int starts = 6;                             ///< the best of them are improved
  int iterations = 150;                       ///< evaluations of each start, in each round
  double seconds_budget = 60.0;               ///< then the best so far is returned
  bool twin_legs = false;                     ///< q23 and q33 identical, as in the paper's verification (sect. 2.1.5)
  std::function<void(const ExcitationProgress&)> progress;  ///< called from several threads, one at a time
  const std::atomic<bool>* interrupted = nullptr;           ///< set: stop and return the best so far
};

/// Condition numbers of the observation matrix at a number of directions; infinite when the data support fewer.
struct ConditionAt {
  int directions = 0;
  double scaled = 0.0;  ///< columns scaled to unit norm
  double raw = 0.0;     ///< SI units as they are
};

/// A planned excitation, and how well conditioned it is.
struct ExcitationPlan {
  FourierSeries series;
  trajectory::Reference reference;  ///< actuator lengths, checked: it may be played
  trajectory::ReferenceCheck check;
  std::vector<LimitUsed> limits;        ///< how much of each limit the series uses, looked at every millisecond
  std::vector<ConditionAt> conditions;  ///< at r = 20, 30, 40, 51, 56, 73, as played (100 Hz, sign of the velocity)
  std::vector<ConditionAt> random_conditions;  ///< of the best random candidate, the same way
  double k = 0.0;                              ///< at the stated directions, scaled
  double random_k = 0.0;                       ///< of the best random candidate
  double gain = 0.0;  ///< fall of the criterion from the best random one: of log k, or of the mean of -log s_i
  int feasible_candidates = 0;
  int evaluations = 0;     ///< of the criterion, mostly with gradient
  bool cut_short = false;  ///< by the budget or by interruption
};

/// Plans an excitation: a finite Fourier series per actuator that is periodic, starts and ends at rest through smooth
/// ramps and keeps all limits of the robot and of the options (lengths, velocity, acceleration, joint angles,
/// singularity margin, peak and rms of the expected force), between samples too. Random feasible series first; then
/// NLopt's SLSQP from the best of them with exact gradients, over the coefficients expressed through dq/dx at the
/// centre (a unit of every variable then moves the pose by a similar amount; in plain actuator coordinates one
/// direction is twenty times as touchy as the others).
/// InputError: options out of range, or a robot without a platform. Refusal: no pose has room for any motion.
ExcitationPlan planExcitation(const mechanism::Robot& robot, const ExcitationOptions& options = {});

}  // namespace knee_robot::excitation
