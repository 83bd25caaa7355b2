#include "knee_robot/recording/spectrum.h"

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/FFT>

#include "knee_robot/base/constants.h"

namespace knee_robot::recording {
namespace {

/// First samples of the segments that lie wholly within used runs.
std::vector<int> segmentStarts(int samples, int length, const std::vector<char>& use) {
  std::vector<int> starts;
  int run = 0;
  for (int n = 0; n < samples; ++n) {
    run = use.empty() || use[static_cast<std::size_t>(n)] ? run + 1 : 0;
    if (run < length || (run - length) % std::max(1, length / 2) != 0) continue;
    starts.push_back(n - length + 1);
  }
  return starts;
}

}  // namespace

Spectrum powerSpectrum(const Eigen::VectorXd& signal, double rate_hz, double segment_s, const std::vector<char>& use) {
  const int samples = static_cast<int>(signal.size());
  const int length = std::min(samples, static_cast<int>(std::lround(segment_s * rate_hz))) / 2 * 2;
  Spectrum s;
  if (length < 8) return s;
  std::vector<int> starts = segmentStarts(samples, length, use);
  if (starts.empty()) starts = segmentStarts(samples, length, {});
  Eigen::VectorXd window(length);
  for (int n = 0; n < length; ++n)
    window[n] = 0.5 - 0.5 * std::cos(kTwoPi * n / length);

  Eigen::FFT<double> fft;
  Eigen::VectorXd power = Eigen::VectorXd::Zero(length / 2 + 1);
  for (const int start : starts) {
    const Eigen::VectorXd piece = signal.segment(start, length);
    const Eigen::VectorXd windowed = (piece.array() - piece.mean()) * window.array();
    Eigen::VectorXcd spectrum;
    fft.fwd(spectrum, windowed);
    power += spectrum.head(power.size()).cwiseAbs2();
  }
  power *= 2.0 / (rate_hz * window.squaredNorm() * static_cast<double>(starts.size()));
  for (Eigen::Index k = 1; k < power.size(); ++k) {
    s.frequency_hz.push_back(static_cast<double>(k) * rate_hz / length);
    s.density.push_back(std::sqrt(power[k]));
  }
  return s;
}

}  // namespace knee_robot::recording
