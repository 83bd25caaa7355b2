#pragma once

#include <string>
#include <vector>

#include "knee_robot/recording/jumps.h"
#include "knee_robot/recording/recording.h"

namespace knee_robot::recording {

/// How a recording is brought onto a uniform grid.
struct SignalOptions {
  double motion_cutoff_hz = 9.0;  ///< zero-phase low-pass of the positions before they are differentiated
  double path_cutoff_hz = 0.0;    ///< of the positions along which friction acts, where that is wider
  double rate_hz = 100.0;         ///< of the result, at most; a slower recording keeps its own rate
  /// A longer interval without rows than both of these is a gap: nothing is known of the motion in it. The cubic between
  /// the rows follows a motion at the cut-off to 0.7 % over a fifth of its cycle (2 pi / 5)^4 / 384.
  double gap_periods = 5.0;             ///< of the rows
  double gap_cycles = 0.2;              ///< of motion_cutoff_hz: what a fast recorder skips when its machine is busy
  std::vector<double> fastest_m_per_s;  ///< per actuator, for findJumps; empty: jumps are not looked for
  std::vector<double> taut_m;           ///< per actuator: half width of the band for taut_m of Signals; empty: none
};

/// Motion and commanded force on a uniform grid: one row a sample, one column an actuator.
struct Signals {
  double period_s = 0.0;          ///< of the grid
  double motion_cutoff_hz = 0.0;  ///< low-pass of the positions
  std::vector<double> time_s;     ///< of the grid, in the recording's own time
  Eigen::MatrixXd position_m;     ///< low-passed at motion_cutoff_hz
  Eigen::MatrixXd velocity_m_per_s;
  Eigen::MatrixXd acceleration_m_per_s2;
  /// Positions and velocity along which friction acts, low-passed wider; no columns: the ones above.
  Eigen::MatrixXd path_m, path_velocity_m_per_s;
  /// The same, low-passed, of the shortest line within a band around the recorded positions: it rests where an encoder
  /// trembles by a step. No columns where none was asked for.
  Eigen::MatrixXd taut_m, taut_velocity_m_per_s;
  Eigen::MatrixXd force_N;  ///< mean of the held command over the grid interval around the sample; otherwise unfiltered
  bool force_is_measured = false;  ///< then force_N is the force at the sample (Recording::force_is_measured)
  /// Way of the recorded position beyond that of position_m (or path_m), per time, over 0.2 s around the sample; never
  /// negative: vibration too fast or too small for it.
  Eigen::MatrixXd tremble_m_per_s;
  Eigen::MatrixXd motor_m;           ///< second encoder, treated as position_m; no columns when there is none
  Eigen::MatrixXd temperature_degC;  ///< no columns when there is none
  std::vector<char> known;           ///< 0 in gaps and during test pulses
  std::vector<char> gap;             ///< 1 where no row tells of the motion: long intervals, and jumps
  std::vector<Jump> jumps;           ///< of the recording's positions
  /// Of an encoder's step: what rounding leaves in position_m, from peak to peak (six standard deviations of white
  /// rounding noise after the low-pass; at least a quarter, because a filtered staircase overshoots; at most one).
  double rounding_left = 1.0;
  std::vector<std::string> notes;     ///< what was done, one sentence each, for the report
  std::vector<std::string> warnings;  ///< those of the notes that say what to look at where the recording was made

  int samples() const { return static_cast<int>(time_s.size()); }
};

/// Brings a recording onto a uniform grid. Positions belong to their rows' times: stale rows at the start are dropped,
/// a cubic through the neighbours is sampled at the recording's usual period, low-passed with zero phase,
/// differentiated, and only then thinned to `rate_hz`. A command (or force) acts from its row to the next one: it is
/// averaged exactly over each grid interval. Jumps are taken out before the low-pass, so that they do not spread, and put
/// back after it; the samples at them are gaps.
/// `force_N` has one row per row of the recording (commandedForce).
/// Throws Refusal when fewer than 20 usable rows remain.
Signals resample(const Recording& recording, const Eigen::MatrixXd& force_N, const SignalOptions& options = {});

/// Means of held signals over the intervals [center - width/2, center + width/2]: row k of `values` holds from
/// time_s[k] to time_s[k + 1], the last one for good, the first one also before its time. One row per center. `time_s`
/// strictly increasing, width positive.
Eigen::MatrixXd heldMeans(const std::vector<double>& time_s, const Eigen::MatrixXd& values,
                          const std::vector<double>& centers_s, double width_s);

/// Values of a uniformly sampled signal in the middle of every row's hold interval [t_k, t_k+1] (the last row: one
/// median period), linearly interpolated and held at the ends: what stands beside row k's force.
Eigen::MatrixXd atHoldIntervals(const Signals& signals, const Eigen::MatrixXd& values,
                                const std::vector<double>& row_time_s);

/// Median interval between rows, s. At least two rows.
double medianPeriod(const std::vector<double>& time_s);

}  // namespace knee_robot::recording
