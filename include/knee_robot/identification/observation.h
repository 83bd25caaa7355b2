#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "knee_robot/identification/columns.h"
#include "knee_robot/identification/motion_path.h"
#include "knee_robot/identification/sliding_path.h"
#include "knee_robot/recording/recording.h"
#include "knee_robot/recording/signals.h"

namespace knee_robot::identification {

/// What decides which samples are used, and how they are filtered.
struct ObservationOptions {
  double cutoff_hz = 3.0;          ///< zero-phase low-pass of both sides of the equation
  double moving_m_per_s = 0.0015;  ///< an axis slower than this does not count as moving
  double condition_max = 0.0;      ///< poses with a worse condition of dq/dx (m, rad) are masked; 0: see conditionLimit
  /// The actuator lengths' distance (m) from a fold (foldDistance) below which the assembly mode counts as unknown,
  /// until it is twice as far again. A recording with cameras passed into the other mode from 2.3 mm: the geometry is
  /// not known better. 0: exact geometry.
  double fold_margin_m = 0.003;
  recording::SignalOptions signals;

  /// Half width, in encoder steps, of the band whose shortest line smooth laws of friction follow (Signals::taut_m); 0:
  /// they follow the low-passed positions.
  double taut_steps = 0.0;

  /// Equations that are fitted, of all actuators together: samples are thinned to that. 0: to ten a period of the
  /// cut-off.
  int most_rows = 0;

  bool motion_cutoff_given = false;  ///< false: see motionCutoff
  bool equations = true;  ///< false: without a regressor, for predictions by a model of constants (dynamics::Model)

  /// Sets the cut-off, and that of the positions unless it follows from the encoders; the grid becomes fine enough for
  /// both.
  void setCutoff(double hz, double motion_hz = 0.0) {
    cutoff_hz = hz;
    signals.rate_hz = std::max(signals.rate_hz, 12.0 * hz);
    motion_cutoff_given = motion_hz > 0.0;
    signals.motion_cutoff_hz = motion_cutoff_given ? motion_hz : 3.0 * hz;
  }
};

/// Samples that are not used for one reason; a sample can have several.
struct Mask {
  std::string reason;
  double share = 0.0;  ///< of all samples
};

/// A recording as equations: force = regressor * parameters, for every sample and actuator, not yet filtered.
struct Observation {
  std::string path;
  std::string name;
  std::string fingerprint;              ///< of the recording
  std::int64_t home_id = 0;             ///< of the recording
  std::vector<double> row_time_s;       ///< of the recording's rows
  Eigen::MatrixXd row_force_N;          ///< commanded, one row per row of the recording
  std::vector<std::string> force_unit;  ///< per actuator, as recorded: N, Nm or A
  recording::Signals signals;
  MotionPath motion;
  std::vector<SlidingPath> sliding;  ///< per actuator: what Coulomb friction follows
  Eigen::MatrixXd
      friction_level;  ///< samples x actuators: factor of Coulomb friction that effects make known; empty: 1
  /// Samples x actuators each: forces of effects, taken off already, whose sizes stay open while a law near rest is
  /// chosen; empty: none.
  std::vector<Eigen::MatrixXd> beside_N;
  std::vector<Eigen::MatrixXd> regressor;  ///< per actuator: samples x columns; Coulomb columns by setFriction
  Eigen::MatrixXd force_filtered_N;        ///< signals.force_N, low-passed
  double cutoff_hz = 0.0;                  ///< of that low-pass
  std::vector<char> usable;  ///< not in a gap, near a singular pose, saturated, or at an end of the recording
  /// 1 where predictions are compared with the recorded force: not in a gap or in the low-pass' reach of one, where nobody
  /// knows what the motion was. Empty: everywhere.
  std::vector<char> judged;
  std::vector<char> judged_rows;  ///< the same of the recording's rows
  std::vector<char> moving;       ///< every axis faster than the limit (velocity low-passed at cutoff_hz)
  Eigen::Matrix<char, Eigen::Dynamic, Eigen::Dynamic> axis_moving;  ///< the same for each axis alone
  double saturated_share = 0.0;                                     ///< of the samples
  std::string clipped;      ///< where a force is cut off below its limit (clipped_force.h); empty: nowhere
  std::vector<Mask> masks;  ///< why samples are left out, and how many
  std::vector<std::string> notes;
  std::vector<std::string> warnings;  ///< those of the notes that say what to look at where the recording was made

  int samples() const { return signals.samples(); }
  bool isJudged(int n) const { return judged.empty() || judged[static_cast<std::size_t>(n)]; }
  int judgedSamples() const;
  int judgedRows() const;
  int axes() const { return static_cast<int>(signals.position_m.cols()); }
};

/// What recordings are warned of, each sentence behind its file.
std::vector<std::string> warningsOf(const std::vector<Observation>& observations);

/// Rows of a matrix that are judged; all of them where `judged` is empty.
Eigen::MatrixXd judgedOnly(const std::vector<char>& judged, const Eigen::MatrixXd& values);

/// The limit in force: that of the options, else the robot file's margin, else (when that is wide open, above 1e6) 60.
double conditionLimit(const mechanism::Robot& robot, const ObservationOptions& options);

/// Low-pass (Hz) of positions recorded at `rate_hz` through which the coarsest encoder's rounding leaves 0.1 mm/s rms of
/// velocity.
double encodersAllow(const mechanism::Robot& robot, double rate_hz);

/// What rounding to the coarsest encoder's steps leaves in velocities below `cutoff_hz`, rms.
double velocityNoise(const mechanism::Robot& robot, double cutoff_hz, double rate_hz);

/// Low-pass (Hz) of the positions before they are differentiated: as wide as the encoders allow, so that friction near
/// rest keeps its shape; three to five times the cut-off. motion_band.h: a wider one.
double motionCutoff(const mechanism::Robot& robot, double cutoff_hz, double rate_hz);

/// Signed force per volt of every actuator.
std::vector<double> forcePerVolt(const mechanism::Robot& robot);

/// Builds the equations of a recording. InputError when recording and robot do not fit together; Refusal when there are
/// too few rows.
Observation observe(const mechanism::Robot& robot, const std::vector<Column>& columns,
                    const recording::Recording& recording, const ObservationOptions& options);
/// Of several recordings, side by side.
std::vector<Observation> observeAll(const mechanism::Robot& robot, const std::vector<Column>& columns,
                                    const std::vector<recording::Recording>& recordings,
                                    const ObservationOptions& options);

/// A share of full Coulomb friction times what effects make of its level.
Eigen::VectorXd atLevel(const Observation& observation, std::size_t actuator, Eigen::VectorXd share);

/// Fills the Coulomb columns for these laws of friction near rest, one per actuator.
void setFriction(Observation& observation, const std::vector<Column>& columns,
                 const std::vector<dynamics::FrictionLaw>& laws);

}  // namespace knee_robot::identification
