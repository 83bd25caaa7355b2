#include "knee_robot/recording/filter.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"

namespace knee_robot::recording {
namespace {

constexpr Eigen::Index kFewestForParabola = 5;  ///< samples
constexpr double kSurelyCurved = 4.0;           ///< standard errors of the curvature

}  // namespace

ZeroPhaseLowPass::ZeroPhaseLowPass(double cutoff_hz, double rate_hz, Continuation continuation)
    : continuation_(continuation) {
  if (!(cutoff_hz > 0.0) || cutoff_hz >= kMostOfRate * rate_hz) return;
  active_ = true;
  padding_ = static_cast<int>(std::ceil(6.0 * rate_hz / cutoff_hz));
  edge_ = static_cast<int>(std::ceil(rate_hz / cutoff_hz));
  // Bilinear transform with the cut-off prewarped; the two pole pairs of the 4th-order Butterworth have these quality
  // factors.
  const double k = std::tan(kPi * cutoff_hz / rate_hz);
  for (int s = 0; s < 2; ++s) {
    const double q = 1.0 / (2.0 * std::cos(kPi / 8.0 * (1 + 2 * s)));
    const double norm = 1.0 / (1.0 + k / q + k * k);
    const double b0 = k * k * norm;
    sections_[s] = {b0, 2.0 * b0, b0, 2.0 * (k * k - 1.0) * norm, (1.0 - k / q + k * k) * norm};
  }
}

/// Forward pass in place, transposed direct form II, each section started in its steady state for the first value. Four
/// signals and both sections go side by side: one alone would wait for its own last result all the time.
void ZeroPhaseLowPass::run(Four& signals) const {
  using State = Eigen::Array4d;
  const State first = signals.col(0);  // the gain at zero frequency is one: output = input = first
  State z1[2], z2[2];
  for (int k = 0; k < 2; ++k) {
    z2[k] = (sections_[k].b2 - sections_[k].a2) * first;
    z1[k] = (sections_[k].b1 - sections_[k].a1) * first + z2[k];
  }
  for (Eigen::Index n = 0; n < signals.cols(); ++n) {
    State value = signals.col(n);
    for (int k = 0; k < 2; ++k) {
      const Section& s = sections_[k];
      const State out = s.b0 * value + z1[k];
      z1[k] = s.b1 * value - s.a1 * out + z2[k];
      z2[k] = s.b2 * value - s.a2 * out;
      value = out;
    }
    signals.col(n) = value;
  }
}

namespace {

using Signals4 = Eigen::Array<double, 4, Eigen::Dynamic>;

/// What four signals are at an end, whatever their last samples alone happen to be: value and curvature (the factor of
/// the square of the distance, in samples).
struct End {
  Eigen::Array4d value, curvature;
};

/// Least squares through these samples, of which the first is the end.
End endOf(const Eigen::Ref<const Signals4>& samples, bool parabola) {
  const Eigen::Index m = samples.cols();
  Eigen::MatrixX3d powers(m, 3);
  for (Eigen::Index i = 0; i < m; ++i) {
    const double distance = static_cast<double>(i) / static_cast<double>(m);
    powers.row(i) << 1.0, distance, parabola ? distance * distance : 0.0;
  }
  const Eigen::Matrix<double, 3, 4> fitted =
      powers.completeOrthogonalDecomposition().solve(samples.matrix().transpose());
  return {fitted.row(0).transpose().array(), fitted.row(2).transpose().array() / static_cast<double>(m * m)};
}

/// Of each signal: what differs from sample to sample (an encoder's steps), from its third differences.
Eigen::Array4d noiseOf(const Eigen::Ref<const Signals4>& samples) {
  constexpr double kSquaresOfWeights = 20.0;  // 1 + 9 + 9 + 1
  const Eigen::Index n = samples.cols() - 3;
  const Signals4 third =
      (samples.middleCols(3, n) - samples.leftCols(n)) - 3.0 * (samples.middleCols(2, n) - samples.middleCols(1, n));
  return (third.square().rowwise().mean() / kSquaresOfWeights).sqrt();
}

/// The parabola through these samples; the straight line of those whose curvature may be noise.
End curvedOr(const End& line, const Eigen::Ref<const Signals4>& samples, const Eigen::Array4d& noise) {
  const double m = static_cast<double>(samples.cols());
  const double error = std::sqrt(180.0 / (m * (m * m - 1.0) * (m * m - 4.0)));  // of the curvature, of the noise
  const End parabola = endOf(samples, true);
  const Eigen::Array<bool, 4, 1> curved = parabola.curvature.abs() > kSurelyCurved * error * noise;
  return {curved.select(parabola.value, line.value), curved.select(parabola.curvature, 0.0)};
}

}  // namespace

void ZeroPhaseLowPass::apply(Eigen::Ref<Eigen::VectorXd> signal) const {
  Eigen::MatrixXd one = signal;
  applyToColumns(one);
  signal = one.col(0);
}

/// Fills `pad` samples at either end.
void ZeroPhaseLowPass::continueBeyondEnds(Four& signals, Eigen::Index pad) const {
  const Eigen::Index n = signals.cols() - 2 * pad, last = pad + n - 1;
  const bool parabola = continuation_ == Continuation::Parabola && n > kFewestForParabola;
  // Reflection doubles its centre: a single odd sample at an end must not become the centre.
  const Eigen::Index for_line = std::clamp<Eigen::Index>(edge_ / 4, 1, n),
                     m = parabola ? std::clamp<Eigen::Index>(edge_ / 2, kFewestForParabola, n) : for_line;
  const Four first = signals.middleCols(pad, m), turned = signals.middleCols(last + 1 - m, m).rowwise().reverse();
  End start = endOf(first.leftCols(for_line), false), end = endOf(turned.leftCols(for_line), false);
  if (parabola) {
    const Eigen::Array4d noise = noiseOf(signals.middleCols(pad, n));
    start = curvedOr(start, first, noise);
    end = curvedOr(end, turned, noise);
  }
  for (Eigen::Index i = 1; i <= pad; ++i) {
    const double square = static_cast<double>(i * i);
    signals.col(pad - i) = 2.0 * (start.value + square * start.curvature) - signals.col(pad + i);
    signals.col(last + i) = 2.0 * (end.value + square * end.curvature) - signals.col(last - i);
  }
}

void ZeroPhaseLowPass::applyToColumns(Eigen::MatrixXd& signals) const {
  const Eigen::Index n = signals.rows();
  if (!active_ || n < 2) return;
  const Eigen::Index pad = std::min<Eigen::Index>(padding_, n - 1);
  Four work(4, n + 2 * pad);
  for (Eigen::Index from = 0; from < signals.cols(); from += 4) {
    const Eigen::Index count = std::min<Eigen::Index>(4, signals.cols() - from);
    work.setZero();
    work.block(0, pad, count, n) = signals.middleCols(from, count).transpose().array();
    continueBeyondEnds(work, pad);
    for (int direction = 0; direction < 2; ++direction) {
      run(work);
      work = work.rowwise().reverse().eval();
    }
    signals.middleCols(from, count) = work.block(0, pad, count, n).transpose().matrix();
  }
}

Eigen::MatrixXd firstDerivative(const Eigen::MatrixXd& x, double h) {
  const Eigen::Index n = x.rows();
  Eigen::MatrixXd d(n, x.cols());
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i >= 2 && i + 2 < n) {
      d.row(i) = (8.0 * (x.row(i + 1) - x.row(i - 1)) - (x.row(i + 2) - x.row(i - 2))) / (12.0 * h);
    } else if (i >= 1 && i + 1 < n) {
      d.row(i) = (x.row(i + 1) - x.row(i - 1)) / (2.0 * h);
    } else if (n == 2) {
      d.row(i) = (x.row(1) - x.row(0)) / h;
    } else if (i == 0) {
      d.row(i) = (4.0 * x.row(1) - 3.0 * x.row(0) - x.row(2)) / (2.0 * h);
    } else {
      d.row(i) = (3.0 * x.row(i) - 4.0 * x.row(i - 1) + x.row(i - 2)) / (2.0 * h);
    }
  }
  return d;
}

Eigen::MatrixXd secondDerivative(const Eigen::MatrixXd& x, double h) {
  const Eigen::Index n = x.rows();
  Eigen::MatrixXd d(n, x.cols());
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    if (i >= 2 && i + 2 < n) {
      d.row(i) =
          (16.0 * (x.row(i + 1) + x.row(i - 1)) - (x.row(i + 2) + x.row(i - 2)) - 30.0 * x.row(i)) / (12.0 * h * h);
    } else {
      d.row(i) = (x.row(i + 1) - 2.0 * x.row(i) + x.row(i - 1)) / (h * h);
    }
  }
  d.row(0) = d.row(1);
  d.row(n - 1) = d.row(n - 2);
  return d;
}

}  // namespace knee_robot::recording
