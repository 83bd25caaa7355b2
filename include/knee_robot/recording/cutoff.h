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
      1.5;                   ///< cut-off over the upper end of what is followed: there the filter takes 4 % and no more
  double lowest_hz = 1.0;    ///< of the result
  double highest_hz = 10.0;  ///< of the result, and of the band that is looked at
  double without_reference_hz = 3.0;  ///< the result when no recording has reference columns
};

/// What the rule found. Frequencies in Hz.
struct CutoffChoice {
  double cutoff_hz = 0.0;
  double drive_hz = 0.0;  ///< below it lies `power_share` of the reference's acceleration power; 0 without references
  double follow_hz =
      0.0;  ///< the recording follows the reference up to here; equal to drive_hz when it follows all of it
  std::vector<double> frequency_hz;     ///< of the two curves, for a plot
  std::vector<double> reference_power;  ///< (m/s2)^2/Hz, mean over actuators, without the file's rounding
  std::vector<double> coherence;        ///< of reference's and position's acceleration, mean over actuators, 0 to 1
  std::string sentence;                 ///< the rule with its numbers, for the report
};

/// Chooses the cut-off frequency from the acceleration spectrum of the references of the given (training) recordings.
///
/// Drive band: the frequency below which 99 % of the reference's acceleration power lies, up to 10 Hz; white rounding noise of the
/// reference's positions, whose acceleration grows with f^4, is estimated above half the Nyquist frequency and taken off. A reference of
/// straight pieces has steps of velocity: its acceleration is white, and no robot follows all of it. So the second limit: the first
/// frequency at which the coherence of the reference's and the recorded acceleration falls below 1/2 (for at least
/// three bins); beyond it more than half of the recorded acceleration is not what the reference asked for, but chatter and noise.
/// The cut-off is 5 times the drive band where the recording follows all of it (the usual rule for robots: the filter is well
/// above the dynamics), otherwise 1.5 times the followed band (the zero-phase filter, 1/(1 + (f/fc)^8), takes 4 % at its end).
///
/// Spectra: Hann windows of 5.12 s or a quarter of the recording, half overlapping, averaged over recordings by length.
/// Recordings without reference columns or with fewer than 200 samples on the 10 ms grid take no part.
CutoffChoice chooseCutoff(const std::vector<const Recording*>& recordings, const CutoffRule& rule = {});

/// The same from uniformly sampled columns (one an actuator), as the function above makes them.
struct UniformMotion {
  double rate_hz = 100.0;
  Eigen::MatrixXd reference_m;
  Eigen::MatrixXd position_m;
};
CutoffChoice chooseCutoff(const std::vector<UniformMotion>& motions, const CutoffRule& rule = {});

}  // namespace knee_robot::recording
