#pragma once

#include <string>
#include <vector>

#include "knee_robot/tracing/trace.h"
#include "knee_robot/trajectory/reference_check.h"

namespace knee_robot::tracing {

/// How far apart two explanations are along a motion. Columns are low-passed as in the fit, weighed by each actuator's
/// noise, and made orthogonal to the baseline's.
struct Separation {
  double angle_rad =
      0.0;  ///< smallest principal angle between the two groups of columns, over all shapes of the second
  double visible_N =
      0.0;  ///< rms of what the first, at its found size, does that neither baseline nor second can mimic
};

/// The motion that would tell two explanations apart.
struct NextExperiment {
  bool planned = false;             ///< the angle grows by a tenth at least, and beyond a degree
  std::string first, second;        ///< "stribeck on actuator 3", "quadratic_drag on actuator 3"
  Separation now, then;             ///< along the training recordings; along the planned motion
  trajectory::Reference reference;  ///< actuator lengths; checkReference accepts it
  trajectory::ReferenceCheck check;
  int motions = 0;     ///< that were looked at
  std::string reason;  ///< why none was planned
};

/// How long the movement may be and how long to look for it.
struct NextExperimentOptions {
  double duration_s = 30.0;
  int random = 40;     ///< motions to start with
  int improving = 40;  ///< variations of the best
  std::uint64_t seed = 1;
};

/// Plans for the first effect that has an explanation it cannot be told from. The motion is a Fourier series of the
/// pose (bench: of the axis) with smooth ends, scaled to the robot's limits (lengths, velocity, acceleration, joint
/// angles, planningCondition); random ones first, then random steps from the best. It maximises the principal angle; an
/// effect that would stay below twice the noise floor counts less in proportion.
NextExperiment planNextExperiment(const mechanism::Robot& robot, const TraceResult& result,
                                  const std::vector<identification::Observation>& training, const TraceOptions& options,
                                  const NextExperimentOptions& plan = {});

/// Separation of effect `first` from `rival` (a candidate, at the same actuator or shared) along recordings.
Separation separationOf(const mechanism::Robot& robot, const TraceResult& result, const FoundEffect& first,
                        const Candidate& rival, std::vector<identification::Observation> recordings,
                        const identification::ObservationOptions& options);

/// What an ideal robot would record along a reference of actuator lengths: positions exactly those, no force.
recording::Recording idealRecording(const trajectory::Reference& reference, int axes);

}  // namespace knee_robot::tracing
