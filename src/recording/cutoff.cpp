#include "knee_robot/recording/cutoff.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/recording/jumps.h"
#include "knee_robot/recording/signals.h"
#include "reference_check.h"

namespace knee_robot::recording {
namespace {

constexpr double kGridRates_hz[] = {100.0, 200.0, 500.0, 1000.0};
constexpr int kFewestSamples = 200;
constexpr double kSegment_s = 5.12;
constexpr int kFewestInSegment = 32;
constexpr int kBinsBelow = 3;  ///< so many bins in a row below the least coherence end the followed band
constexpr double kPowerToCount =
    1e-3;  ///< bins with less than this share of the largest power say nothing of following
constexpr double kTinyPower = 1e-30;
constexpr double kPause = 10.5;       ///< periods between two rows beyond which the motion itself may not have gone on
constexpr double kEnoughQuiet = 0.5;  ///< share of the segments without a pause that speaks for all
constexpr int kFirstRows = 50;        ///< may be stale: what jumps there is left out when the recording is resampled
constexpr double kGap = 1.5;          ///< periods between two rows beyond which some are missing
/// Periods a row that a recording may last: a longer one is mostly gaps, and is refused when it is resampled.
constexpr double kMostPeriods = 20.0;

/// Averaged spectra of accelerations on a common frequency axis; one column an actuator.
struct Spectra {
  double step_hz = 0.0;
  Eigen::ArrayXXd reference;  ///< power density of the reference's acceleration
  Eigen::ArrayXXd position;   ///< of the recorded one
  Eigen::Array<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic> cross;
  int segments = 0;
};

Eigen::MatrixXd velocities(const Eigen::MatrixXd& x, double rate) {
  return (x.bottomRows(x.rows() - 2) - x.topRows(x.rows() - 2)) * (0.5 * rate);
}

Eigen::MatrixXd accelerations(const Eigen::MatrixXd& x, double rate) {
  const Eigen::Index n = x.rows();
  return (x.topRows(n - 2) - 2.0 * x.middleRows(1, n - 2) + x.bottomRows(n - 2)) * (rate * rate);
}

/// Reference's and recorded motion on one grid, differentiated.
struct Pair {
  Eigen::MatrixXd wanted, done;
  const std::vector<double>* pauses_s = nullptr;  ///< of the motion
};

/// First samples of the half-overlapping segments of one motion; without those in which the recording paused.
std::vector<Eigen::Index> segmentsOf(const Pair& motion, double rate_hz, int length, bool with_pauses) {
  std::vector<Eigen::Index> starts;
  for (Eigen::Index start = 0; start + length <= motion.wanted.rows(); start += length / 2) {
    const double from_s = static_cast<double>(start) / rate_hz, to_s = from_s + length / rate_hz;
    const bool pauses = std::any_of(motion.pauses_s->begin(), motion.pauses_s->end(),
                                    [&](double time_s) { return time_s > from_s && time_s < to_s; });
    if (with_pauses || !pauses) starts.push_back(start);
  }
  return starts;
}

/// Adds windowed segments of one motion to the sums.
void addMotion(const Pair& motion, const std::vector<Eigen::Index>& starts, double rate_hz, int length, Spectra& sum) {
  const Eigen::MatrixXd &wanted = motion.wanted, &done = motion.done;
  Eigen::VectorXd window(length);
  for (int i = 0; i < length; ++i)
    window[i] = 0.5 - 0.5 * std::cos(kTwoPi * (i + 0.5) / length);
  const double scale = 2.0 / (rate_hz * window.squaredNorm());
  Eigen::FFT<double> fft;
  Eigen::VectorXcd reference(length), position(length);
  for (const Eigen::Index start : starts) {
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

Spectra spectraOf(const std::vector<Pair>& motions, double rate) {
  Eigen::Index shortest = motions.front().done.rows();
  for (const Pair& motion : motions)
    shortest = std::min(shortest, motion.done.rows());
  const double least =
      std::min<double>(kFewestInSegment, static_cast<double>(shortest / 4));  // of a very slow recording
  const double wanted = std::min<double>(kSegment_s * rate, static_cast<double>(shortest / 4));
  const int length = static_cast<int>(std::max(wanted, least)) / 2 * 2;
  Spectra sum;
  sum.step_hz = rate / length;
  const Eigen::Index bins = length / 2 + 1, axes = motions.front().done.cols();
  sum.reference = sum.position = Eigen::ArrayXXd::Zero(bins, axes);
  sum.cross.setZero(bins, axes);
  const auto segments = [&](bool with_pauses) {
    std::vector<std::vector<Eigen::Index>> starts;
    std::size_t count = 0;
    for (const Pair& motion : motions)
      count += starts.emplace_back(segmentsOf(motion, rate, length, with_pauses)).size();
    return std::pair(starts, count);
  };
  auto [starts, all] = segments(true);
  if (const auto [quiet, count] = segments(false);
      static_cast<double>(count) >= kEnoughQuiet * static_cast<double>(all))
    starts = quiet;
  for (std::size_t m = 0; m < motions.size(); ++m)
    addMotion(motions[m], starts[m], rate, length, sum);
  sum.reference /= sum.segments;
  sum.position /= sum.segments;
  sum.cross /= static_cast<double>(sum.segments);
  return sum;
}

/// What white noise of the positions has, if all power above half the Nyquist frequency is such noise: of the velocity
/// (`order` 1, central difference) or acceleration (2). Of a white acceleration this is 1 % at a fifth of the Nyquist
/// frequency, so that a wrong guess does no harm.
Eigen::ArrayXd positionNoise(const Eigen::ArrayXd& power, int order) {
  const Eigen::Index bins = power.size();
  Eigen::ArrayXd shape(bins);
  for (Eigen::Index k = 0; k < bins; ++k) {
    const double turn = kPi * static_cast<double>(k) / static_cast<double>(bins - 1);
    shape[k] = order == 1 ? std::pow(std::sin(turn), 2) : std::pow(std::sin(0.5 * turn), 4);
  }
  const Eigen::Index upper = bins - bins / 2;
  return power.tail(upper).sum() / std::max(kTinyPower, shape.tail(upper).sum()) * shape;
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

/// Frequency below which a share of the power below `highest_hz` lies.
double bandOf(const Eigen::ArrayXd& power, double step_hz, double share, double highest_hz) {
  const Eigen::Index last = std::min(power.size() - 1, static_cast<Eigen::Index>(highest_hz / step_hz));
  const double whole = power.head(last + 1).sum();
  double sum = 0.0;
  for (Eigen::Index k = 0; k <= last; ++k) {
    sum += power[k];
    if (sum >= share * whole) return std::max(1.0, static_cast<double>(k)) * step_hz;
  }
  return highest_hz;
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

/// `rate_hz`: of the slowest recording; 0: not known.
CutoffChoice withoutMotion(const CutoffRule& rule, double rate_hz) {
  CutoffChoice choice;
  choice.cutoff_hz = rule.without_motion_hz;
  if (rate_hz > 0.0)
    choice.cutoff_hz = std::min(choice.cutoff_hz, std::max(rule.lowest_hz, rule.share_of_rate * rate_hz));
  choice.sentence =
      "Cut-off " + shortNumber(choice.cutoff_hz, 3) +
      " Hz, the usual value: the training recordings have no reference or no motion (or are too short) to "
      "choose it from.";
  return choice;
}

std::string sentenceOf(const CutoffChoice& choice, const CutoffRule& rule, bool reference, double free_hz,
                       double highest_hz) {
  const bool all = choice.follow_hz >= choice.drive_hz;
  std::string text = "Cut-off " + shortNumber(choice.cutoff_hz, 3) + " Hz: ";
  text += reference
              ? shortNumber(100.0 * rule.power_share, 4) + " % of the reference's acceleration power lies below " +
                    shortNumber(choice.drive_hz, 3) + " Hz"
              : "no reference; " + shortNumber(100.0 * rule.velocity_share, 4) +
                    " % of the recorded velocity's power lies below " + shortNumber(choice.drive_hz, 3) + " Hz";
  if (all) {
    text += std::string(reference ? ", all of which the recording follows" : ", above the positions' noise") +
            "; times " + shortNumber(rule.drive_margin, 3);
  } else {
    text += (reference ? ", the recording follows it up to " : ", above the positions' noise up to ") +
            shortNumber(choice.follow_hz, 3) + " Hz" +
            (reference ? " (coherence " + shortNumber(rule.coherence_least, 2) + ")" : "") + "; times " +
            shortNumber(rule.follow_margin, 3);
  }
  if (free_hz != choice.cutoff_hz)
    text += ", kept between " + shortNumber(rule.lowest_hz, 3) + " and " + shortNumber(highest_hz, 3) + " Hz";
  return text + ".";
}

/// End of the band in which the power is clearly more than noise.
double aboveNoise(const Eigen::ArrayXd& power, const Eigen::ArrayXd& noise, double step_hz, double drive_hz,
                  const CutoffRule& rule) {
  for (Eigen::Index k = 1; k < power.size() && step_hz * static_cast<double>(k) <= drive_hz; ++k) {
    if (power[k] > kPowerToCount * power.maxCoeff() && power[k] < rule.noise_least * noise[k])
      return step_hz * static_cast<double>(k);
  }
  return drive_hz;
}

void keepCurves(const Eigen::ArrayXd& power, const Eigen::ArrayXd& coherent, double step_hz, CutoffChoice& choice) {
  for (Eigen::Index k = 0; k < power.size(); ++k) {
    choice.frequency_hz.push_back(step_hz * static_cast<double>(k));
    choice.reference_power.push_back(power[k]);
    choice.coherence.push_back(coherent[k]);
  }
}

/// One grid, and whether it was fine enough for what was found.
CutoffChoice chooseOnGrid(const std::vector<UniformMotion>& motions, const CutoffRule& rule, bool& fine_enough) {
  fine_enough = true;
  bool reference = true;
  std::vector<const UniformMotion*> usable;
  for (const UniformMotion& motion : motions) {
    const bool fits = usable.empty() || (motion.position_m.cols() == usable.front()->position_m.cols() &&
                                         std::abs(motion.rate_hz - usable.front()->rate_hz) < 0.01 * motion.rate_hz);
    if (motion.position_m.rows() < kFewestSamples || !fits) continue;
    usable.push_back(&motion);
    reference = reference && motion.reference_m.cols() > 0;
  }
  double slowest_hz = 0.0;
  for (const UniformMotion& motion : motions) {
    if (slowest_hz == 0.0 || (motion.rate_hz > 0.0 && motion.rate_hz < slowest_hz)) slowest_hz = motion.rate_hz;
  }
  if (usable.empty()) return withoutMotion(rule, slowest_hz);
  const double rate = usable.front()->rate_hz, highest_hz = rule.share_of_rate * rate;
  std::vector<Pair> speeds, accelerations_of;
  for (const UniformMotion* motion : usable) {
    const Eigen::MatrixXd& wanted = reference ? motion->reference_m : motion->position_m;
    speeds.push_back({velocities(wanted, rate), velocities(wanted, rate), &motion->pauses_s});
    accelerations_of.push_back(
        {accelerations(wanted, rate), accelerations(motion->position_m, rate), &motion->pauses_s});
  }
  const Spectra speed = spectraOf(speeds, rate), spectra = spectraOf(accelerations_of, rate);
  const Eigen::ArrayXd raw_speed = speed.reference.rowwise().mean(), speed_noise = positionNoise(raw_speed, 1);
  const Eigen::ArrayXd raw = spectra.reference.rowwise().mean();
  const Eigen::ArrayXd power = (raw - positionNoise(raw, 2)).max(0.0), coherent = coherence(spectra);
  if (!(power.sum() > kTinyPower)) return withoutMotion(rule, slowest_hz);
  CutoffChoice choice;
  const double step_hz = spectra.step_hz;
  choice.velocity_hz = bandOf((raw_speed - speed_noise).max(0.0), step_hz, rule.velocity_share, highest_hz);
  choice.drive_hz = reference ? bandOf(power, step_hz, rule.power_share, highest_hz) : choice.velocity_hz;
  choice.follow_hz = reference ? followedBand(coherent, power, step_hz, choice.drive_hz, rule)
                               : aboveNoise(raw_speed, speed_noise, step_hz, choice.drive_hz, rule);
  const double free_hz =
      choice.follow_hz < choice.drive_hz ? rule.follow_margin * choice.follow_hz : rule.drive_margin * choice.drive_hz;
  fine_enough = free_hz <= highest_hz;
  choice.cutoff_hz = std::clamp(free_hz, rule.lowest_hz, std::max(rule.lowest_hz, highest_hz));
  keepCurves(power, coherent, step_hz, choice);
  choice.sentence = sentenceOf(choice, rule, reference, free_hz, highest_hz);
  return choice;
}

/// Rows in even steps where the recording skipped some: what moves goes on in between. Held, it would jump at the end
/// of the gap, in reference and position alike: as if the robot followed something very fast.
struct WithoutGaps {
  std::vector<double> time_s;
  Eigen::MatrixXd reference_m, position_m;
};

/// Also where somebody has set the clock meanwhile: years in even steps find no room.
bool isMostlyGaps(const Recording& r) {
  return r.time_s.back() - r.time_s.front() > kMostPeriods * medianPeriod(r.time_s) * r.rows();
}

WithoutGaps withoutGaps(const Recording& r, const Eigen::MatrixXd& position_m) {
  const double period = medianPeriod(r.time_s);
  std::vector<std::size_t> from;  // row before, and share of the way to the next one
  std::vector<double> share;
  WithoutGaps out;
  for (std::size_t k = 0; k < r.time_s.size(); ++k) {
    const double step = k + 1 < r.time_s.size() ? r.time_s[k + 1] - r.time_s[k] : 0.0;
    const int pieces = step > kGap * period ? static_cast<int>(std::round(step / period)) : 1;
    for (int piece = 0; piece < pieces; ++piece) {
      from.push_back(k);
      share.push_back(static_cast<double>(piece) / pieces);
      out.time_s.push_back(r.time_s[k] + share.back() * step);
    }
  }
  const auto filled = [&](const Eigen::MatrixXd& x) {
    Eigen::MatrixXd all(x.cols() > 0 ? static_cast<Eigen::Index>(from.size()) : 0, x.cols());
    for (Eigen::Index n = 0; n < all.rows(); ++n) {
      const std::size_t k = from[static_cast<std::size_t>(n)];
      const double to_next = share[static_cast<std::size_t>(n)];
      const Eigen::Index row = static_cast<Eigen::Index>(k), next = std::min(row + 1, x.rows() - 1);
      all.row(n) = (1.0 - to_next) * x.row(row) + to_next * x.row(next);
    }
    return all;
  };
  out.reference_m = filled(r.reference_m);
  out.position_m = filled(position_m);
  return out;
}

/// A recording on a uniform grid of at most `grid_hz`. The mean of the held rows over each step treats both signals
/// alike and does not alias a faster recording.
UniformMotion onGrid(const Recording& r, double grid_hz, bool with_reference, const CutoffRule& rule) {
  const double step = std::max(1.0 / grid_hz, std::round(grid_hz * medianPeriod(r.time_s)) / grid_hz);
  if (isMostlyGaps(r)) return {};
  std::vector<double> grid;
  for (double t = r.time_s.front() + 0.5 * step; t + 0.5 * step <= r.time_s.back(); t += step)
    grid.push_back(t);
  const std::vector<Jump> jumps = findJumps(r, std::min(kFirstRows, r.rows() / 4), rule.fastest_m_per_s);
  const WithoutGaps rows =
      withoutGaps(r, jumps.empty() ? r.position_m : r.position_m - jumpsUntil(jumps, r.time_s, r.position_m.cols()));
  UniformMotion motion;
  motion.rate_hz = 1.0 / step;
  const double pause_s = kPause * medianPeriod(r.time_s);
  for (std::size_t k = 1; k < r.time_s.size(); ++k)
    if (r.time_s[k] - r.time_s[k - 1] > pause_s) motion.pauses_s.push_back(r.time_s[k] - r.time_s.front());
  motion.position_m = heldMeans(rows.time_s, rows.position_m, grid, step);
  if (r.reference_m.cols() > 0 && with_reference)
    motion.reference_m = heldMeans(rows.time_s, rows.reference_m, grid, step);
  return motion;
}

}  // namespace

CutoffChoice chooseCutoff(const std::vector<UniformMotion>& motions, const CutoffRule& rule) {
  bool fine_enough = true;
  return chooseOnGrid(motions, rule, fine_enough);
}

namespace {

/// By the references only when all of them are followed.
CutoffChoice chooseOnFineGrid(const std::vector<const Recording*>& recordings, bool with_reference,
                              const CutoffRule& rule) {
  double slowest_hz = 0.0, rate_before = 0.0;
  for (const Recording* r : recordings) {
    if (r->time_s.size() < 2) continue;
    const double rate_hz = 1.0 / medianPeriod(r->time_s);
    if (slowest_hz == 0.0 || rate_hz < slowest_hz) slowest_hz = rate_hz;
  }
  CutoffChoice choice = withoutMotion(rule, slowest_hz);
  for (const double grid_hz : kGridRates_hz) {
    std::vector<UniformMotion> motions;
    for (const Recording* r : recordings) {
      if (r->rows() >= kFewestSamples) motions.push_back(onGrid(*r, grid_hz, with_reference, rule));
    }
    if (motions.empty() || motions.front().rate_hz < 1.01 * rate_before) return choice;
    rate_before = motions.front().rate_hz;
    bool fine_enough = true;
    choice = chooseOnGrid(motions, rule, fine_enough);
    if (fine_enough) return choice;
  }
  return choice;
}

}  // namespace

CutoffChoice chooseCutoff(const std::vector<const Recording*>& recordings, const CutoffRule& rule) {
  std::string ignored;
  for (const Recording* r : recordings) {
    const std::string why = whyNotFollowed(*r);
    if (!why.empty() && ignored.empty())
      ignored = " " + r->path + ": " + why + ": it is not followed, and references do not decide the cut-off.";
  }
  CutoffChoice choice = chooseOnFineGrid(recordings, ignored.empty(), rule);
  choice.sentence += ignored;
  return choice;
}

}  // namespace knee_robot::recording
