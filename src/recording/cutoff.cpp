#include "knee_robot/recording/cutoff.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "knee_robot/base/numbers.h"
#include "knee_robot/recording/signals.h"

namespace knee_robot::recording {
namespace {

constexpr double kGridRate_hz = 100.0;
constexpr int kFewestSamples = 200;
constexpr double kSegment_s = 5.12;
constexpr int kBinsBelow = 3;  ///< so many bins in a row below the least coherence end the followed band
constexpr double kPowerToCount =
    1e-3;  ///< bins with less than this share of the largest power say nothing of following
constexpr double kTinyPower = 1e-30;

/// Averaged spectra of accelerations on a common frequency axis; one column an actuator.
struct Spectra {
  double step_hz = 0.0;
  Eigen::ArrayXXd reference;  ///< power density of the reference's acceleration
  Eigen::ArrayXXd position;   ///< of the recorded one
  Eigen::Array<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic> cross;
  int segments = 0;
};

Eigen::MatrixXd accelerations(const Eigen::MatrixXd& x, double rate) {
  const Eigen::Index n = x.rows();
  return (x.topRows(n - 2) - 2.0 * x.middleRows(1, n - 2) + x.bottomRows(n - 2)) * (rate * rate);
}

/// Adds the windowed segments of one motion to the sums.
void addMotion(const UniformMotion& motion, int length, Spectra& sum) {
  const Eigen::MatrixXd wanted = accelerations(motion.reference_m, motion.rate_hz);
  const Eigen::MatrixXd done = accelerations(motion.position_m, motion.rate_hz);
  Eigen::VectorXd window(length);
  for (int i = 0; i < length; ++i)
    window[i] = 0.5 - 0.5 * std::cos(2.0 * M_PI * (i + 0.5) / length);
  const double scale = 2.0 / (motion.rate_hz * window.squaredNorm());
  Eigen::FFT<double> fft;
  Eigen::VectorXcd reference(length), position(length);
  for (Eigen::Index start = 0; start + length <= wanted.rows(); start += length / 2) {
    for (Eigen::Index i = 0; i < wanted.cols(); ++i) {
      fft.fwd(reference, Eigen::VectorXd(wanted.col(i).segment(start, length).cwiseProduct(window)));
      fft.fwd(position, Eigen::VectorXd(done.col(i).segment(start, length).cwiseProduct(window)));
      const Eigen::Index bins = sum.reference.rows();
      sum.reference.col(i) += scale * reference.head(bins).array().abs2();
      sum.position.col(i) += scale * position.head(bins).array().abs2();
      sum.cross.col(i) += scale * reference.head(bins).array().conjugate() * position.head(bins).array();
    }
    ++sum.segments;
  }
}

Spectra spectraOf(const std::vector<UniformMotion>& motions) {
  Eigen::Index shortest = motions.front().reference_m.rows();
  for (const UniformMotion& motion : motions)
    shortest = std::min(shortest, motion.reference_m.rows());
  const double rate = motions.front().rate_hz;
  const int length =
      static_cast<int>(std::min<double>(kSegment_s * rate, static_cast<double>((shortest - 2) / 4))) / 2 * 2;
  Spectra sum;
  sum.step_hz = rate / length;
  const Eigen::Index bins = length / 2 + 1, axes = motions.front().reference_m.cols();
  sum.reference = sum.position = Eigen::ArrayXXd::Zero(bins, axes);
  sum.cross.setZero(bins, axes);
  for (const UniformMotion& motion : motions)
    addMotion(motion, length, sum);
  sum.reference /= sum.segments;
  sum.position /= sum.segments;
  sum.cross /= static_cast<double>(sum.segments);
  return sum;
}

/// Power density of the reference's acceleration, mean over the actuators, less what white noise of its positions would have if all
/// power above half the Nyquist frequency were such noise. Of a white acceleration this takes 1 % at a fifth of the Nyquist
/// frequency, so that a wrong guess does no harm.
Eigen::ArrayXd referencePower(const Spectra& s) {
  Eigen::ArrayXd power = s.reference.rowwise().mean();
  const Eigen::Index bins = power.size();
  Eigen::ArrayXd shape(bins);  // of the second difference of white noise
  for (Eigen::Index k = 0; k < bins; ++k)
    shape[k] = std::pow(std::sin(0.5 * M_PI * static_cast<double>(k) / static_cast<double>(bins - 1)), 4);
  const Eigen::Index upper = bins - bins / 2;
  const double noise = power.tail(upper).sum() / shape.tail(upper).sum();
  return (power - noise * shape).max(0.0);
}

/// Coherence, mean over actuators, less its bias for a finite number of segments, then a running mean of three bins.
Eigen::ArrayXd coherence(const Spectra& s) {
  const Eigen::ArrayXd raw = (s.cross.abs2() / (s.reference * s.position + kTinyPower)).rowwise().mean();
  const double bias = std::min(0.5, 1.0 / (0.6 * s.segments + 0.4));  // half-overlapping segments count about 0.6 each
  const Eigen::ArrayXd fair = ((raw - bias) / (1.0 - bias)).max(0.0);
  Eigen::ArrayXd smooth = fair;
  for (Eigen::Index k = 1; k + 1 < fair.size(); ++k)
    smooth[k] = (fair[k - 1] + fair[k] + fair[k + 1]) / 3.0;
  smooth[0] = fair.size() > 1 ? fair[1] : fair[0];
  return smooth;
}

double driveBand(const Eigen::ArrayXd& power, double step_hz, const CutoffRule& rule) {
  const Eigen::Index last = std::min(power.size() - 1, static_cast<Eigen::Index>(rule.highest_hz / step_hz));
  const double whole = power.head(last + 1).sum();
  double sum = 0.0;
  for (Eigen::Index k = 0; k <= last; ++k) {
    sum += power[k];
    if (sum >= rule.power_share * whole) return step_hz * static_cast<double>(k);
  }
  return rule.highest_hz;
}

double followedBand(const Eigen::ArrayXd& coherent, const Eigen::ArrayXd& power, double step_hz, double drive_hz,
                    const CutoffRule& rule) {
  const double least_power = kPowerToCount * power.maxCoeff();
  int below = 0;
  double first_hz = drive_hz;
  for (Eigen::Index k = 1; k < power.size() && step_hz * static_cast<double>(k) <= drive_hz; ++k) {
    if (power[k] < least_power) continue;
    if (coherent[k] >= rule.coherence_least) {
      below = 0;
      continue;
    }
    if (++below == 1) first_hz = step_hz * static_cast<double>(k);
    if (below == kBinsBelow) return first_hz;
  }
  return drive_hz;
}

CutoffChoice withoutReference(const CutoffRule& rule) {
  CutoffChoice choice;
  choice.cutoff_hz = rule.without_reference_hz;
  choice.sentence =
      "Cut-off " + shortNumber(choice.cutoff_hz, 3) +
      " Hz, the usual value: the training recordings have no reference columns (or are too short) to choose it from.";
  return choice;
}

std::string sentenceOf(const CutoffChoice& choice, const CutoffRule& rule, double free_hz) {
  const bool all = choice.follow_hz >= choice.drive_hz;
  std::string text = "Cut-off " + shortNumber(choice.cutoff_hz, 3) +
                     " Hz: " + shortNumber(100.0 * rule.power_share, 4) +
                     " % of the reference's acceleration power lies below " + shortNumber(choice.drive_hz, 3) + " Hz";
  text += all ? ", all of which the recording follows; times " + shortNumber(rule.drive_margin, 3)
              : ", the recording follows it up to " + shortNumber(choice.follow_hz, 3) + " Hz (coherence " +
                    shortNumber(rule.coherence_least, 2) + "); times " + shortNumber(rule.follow_margin, 3);
  if (free_hz != choice.cutoff_hz)
    text += ", kept between " + shortNumber(rule.lowest_hz, 3) + " and " + shortNumber(rule.highest_hz, 3) + " Hz";
  return text + ".";
}

}  // namespace

CutoffChoice chooseCutoff(const std::vector<UniformMotion>& motions, const CutoffRule& rule) {
  std::vector<UniformMotion> usable;
  for (const UniformMotion& motion : motions) {
    const bool fits = usable.empty() || (motion.reference_m.cols() == usable.front().reference_m.cols() &&
                                         std::abs(motion.rate_hz - usable.front().rate_hz) < 0.01 * motion.rate_hz);
    if (motion.reference_m.cols() > 0 && motion.reference_m.rows() >= kFewestSamples && fits) usable.push_back(motion);
  }
  if (usable.empty()) return withoutReference(rule);
  const Spectra spectra = spectraOf(usable);
  const Eigen::ArrayXd power = referencePower(spectra), coherent = coherence(spectra);
  if (!(power.sum() > kTinyPower)) return withoutReference(rule);
  CutoffChoice choice;
  choice.drive_hz = std::max(spectra.step_hz, driveBand(power, spectra.step_hz, rule));
  choice.follow_hz = followedBand(coherent, power, spectra.step_hz, choice.drive_hz, rule);
  const double free_hz =
      choice.follow_hz < choice.drive_hz ? rule.follow_margin * choice.follow_hz : rule.drive_margin * choice.drive_hz;
  choice.cutoff_hz = std::clamp(free_hz, rule.lowest_hz, rule.highest_hz);
  for (Eigen::Index k = 0; k < power.size(); ++k) {
    choice.frequency_hz.push_back(spectra.step_hz * static_cast<double>(k));
    choice.reference_power.push_back(power[k]);
    choice.coherence.push_back(coherent[k]);
  }
  choice.sentence = sentenceOf(choice, rule, free_hz);
  return choice;
}

CutoffChoice chooseCutoff(const std::vector<const Recording*>& recordings, const CutoffRule& rule) {
  std::vector<UniformMotion> motions;
  for (const Recording* r : recordings) {
    if (r->reference_m.cols() == 0 || r->rows() < kFewestSamples) continue;
    // All on one grid. The mean of the held rows over each step treats both signals alike and does not alias a faster recording.
    const double step = std::max(1.0 / kGridRate_hz, std::round(kGridRate_hz * medianPeriod(r->time_s)) / kGridRate_hz);
    std::vector<double> grid;
    for (double t = r->time_s.front() + 0.5 * step; t + 0.5 * step <= r->time_s.back(); t += step)
      grid.push_back(t);
    motions.push_back({1.0 / step, heldMeans(r->time_s, r->reference_m, grid, step),
                       heldMeans(r->time_s, r->position_m, grid, step)});
  }
  return chooseCutoff(motions, rule);
}

}  // namespace knee_robot::recording
