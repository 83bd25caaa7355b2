#pragma once

#include <Eigen/Core>
#include <vector>

namespace knee_robot::recording {

/// One-sided amplitude spectrum: rms of the signal within each band of `1 / segment_s` width would be root(density *
/// width).
struct Spectrum {
  std::vector<double> frequency_hz;
  std::vector<double> density;  ///< root of the power density: unit of the signal per root(Hz)
};

/// Welch's estimate: segments of `segment_s` (shorter when the signal is), half overlapping, mean removed, Hann window.
/// Samples for which `use` is 0 break the signal into runs; a run shorter than a segment is left out, unless there is
/// none that is long enough:
/// then `use` is ignored. Empty for less than 8 samples.
Spectrum powerSpectrum(const Eigen::VectorXd& signal, double rate_hz, double segment_s,
                       const std::vector<char>& use = {});

}  // namespace knee_robot::recording
