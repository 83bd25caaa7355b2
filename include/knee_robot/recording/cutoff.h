#pragma once

#include <string>
#include <vector>

#include "knee_robot/recording/recording.h"

namespace knee_robot::recording {

/// The rule by which the low-pass of both sides of the identification's equation is chosen (see chooseCutoff).
struct CutoffRule {
  double power_share = 0.99;  ///< of the reference's acceleration power that the drive band holds
  double drive_margin = 5.0;  ///< cut-off over the upper end of the drive band, where the recording follows all of it
  double coherence_least =
      0.5;  ///< the recording follows the reference as far as their accelerations' coherence is this
  double follow_margin =
      1.5;                 ///< cut-off over the upper end of what is followed: there the filter takes 4 % and no more
  double lowest_hz = 1.0;  ///< of the result
  double share_of_rate = 0.1;    ///< of the recordings' rate: the highest result; a held command says nothing beyond
  double velocity_share = 0.95;  ///< without references: of the recorded velocity's power that the drive band holds
  double noise_least = 2.0;      ///< without references: power over that of white position noise up to which it counts
  std::vector<double> fastest_m_per_s;  ///< per actuator: jumps (findJumps) are no motion; empty: not looked for
  double without_motion_hz = 3.0;       ///< the result when the recordings say nothing: too short, or no motion
};

/// What the rule found. Frequencies in Hz.
struct CutoffChoice {
  double cutoff_hz = 0.0;
  double drive_hz = 0.0;  ///< below it lies `power_share` of the reference's acceleration power; 0 when nothing moves
  double velocity_hz =
      0.0;  ///< below it lies `velocity_share` of the velocity's power (reference's, or the recorded one)
  double follow_hz =
      0.0;  ///< the recording follows the reference up to here; equal to drive_hz when it follows all of it
  std::vector<double> frequency_hz;     ///< of the two curves, for a plot
  std::vector<double> reference_power;  ///< (m/s2)^2/Hz, mean over actuators, without the file's rounding
  std::vector<double> coherence;        ///< of reference's and position's acceleration, mean over actuators, 0 to 1
  std::string sentence;                 ///< the rule with its numbers, for the report
};

/// Chooses the cut-off frequency from the spectra of the given (training) recordings' motion.
///
/// Drive band: the frequency below which 99 % of the reference's acceleration power lies; white rounding noise of the
/// reference's positions, whose acceleration grows with f^4, is estimated above half the Nyquist frequency and taken
/// off. A reference of straight pieces has steps of velocity: its acceleration is white, and no robot follows all of
/// it. So the second limit: the first frequency at which the coherence of the reference's and the recorded acceleration
/// falls below 1/2 (for at least three bins); beyond it more than half of the recorded acceleration is not what the
/// reference asked for, but chatter and the encoders' noise. The cut-off is 5 times the drive band where the recording
/// follows all of it (the usual rule for robots: the filter is well above the dynamics), otherwise 1.5 times the
/// followed band (the zero-phase filter, 1/(1 + (f/fc)^8), takes 4 % at its end).
///
/// Without references the drive band is that of 95 % of the recorded velocity's power (its acceleration is mostly what
/// friction and encoders make), and it is followed as far as that power is twice what white noise of the positions has.
///
/// Both are looked at on a grid of 100 Hz, as references are given and commands held; only when the result would lie
/// above a tenth of that, on 200, 500 and 1000 Hz, as far as the recordings are that fast. There is no other upper end.
///
/// Where a recording skipped rows, what moves is taken to go on in between: a held value that jumps at the end of a gap
/// is in reference and position alike, and looks like very fast motion that the robot follows. After more than ten rows
/// reference and robot may have stood still with the controller, too: segments with such a pause take no part while
/// half of them have none.
///
/// References that are not followed at all (whyNotFollowed) decide nothing: then there is no reference, and the sentence
/// says why.
///
/// Spectra: Hann windows of 5.12 s or a quarter of the recording, half overlapping, averaged over recordings by length.
/// Recordings with fewer than 200 samples on the grid take no part.
CutoffChoice chooseCutoff(const std::vector<const Recording*>& recordings, const CutoffRule& rule = {});

/// The same from uniformly sampled columns (one an actuator), as the function above makes them; on their own grid
/// alone.
struct UniformMotion {
  double rate_hz = 100.0;
  Eigen::MatrixXd reference_m;  ///< may have no columns
  Eigen::MatrixXd position_m;
  std::vector<double> pauses_s;  ///< times from the first sample at which the recording had paused
};
CutoffChoice chooseCutoff(const std::vector<UniformMotion>& motions, const CutoffRule& rule = {});

}  // namespace knee_robot::recording
