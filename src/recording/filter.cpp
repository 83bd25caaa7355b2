#include "knee_robot/recording/filter.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"

namespace knee_robot::recording {

ZeroPhaseLowPass::ZeroPhaseLowPass(double cutoff_hz, double rate_hz) {
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

/// Value at the first of these samples of the straight line through all of them: what a signal's end is, whatever its
/// last sample alone happens to be.
Eigen::Array4d lineAtFirst(const Eigen::Ref<const Eigen::Array<double, 4, Eigen::Dynamic>>& samples) {
  const Eigen::Index m = samples.cols();
  Eigen::Array4d value = Eigen::Array4d::Zero();
  for (Eigen::Index i = 0; i < m; ++i) {
    const double weight = m == 1 ? 1.0 : (2.0 * (2.0 * m - 1.0) - 6.0 * static_cast<double>(i)) / (m * (m + 1.0));
    value += weight * samples.col(i);
  }
  return value;
}

}  // namespace

void ZeroPhaseLowPass::apply(Eigen::Ref<Eigen::VectorXd> signal) const {
  Eigen::MatrixXd one = signal;
  applyToColumns(one);
  signal = one.col(0);
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
    // Reflection doubles its centre: a single odd sample at an end must not become the centre.
    const Eigen::Index fitted = std::clamp<Eigen::Index>(edge_ / 4, 1, n);
    const Eigen::Array4d start = lineAtFirst(work.middleCols(pad, fitted));
    const Eigen::Array4d end = lineAtFirst(work.middleCols(pad + n - fitted, fitted).rowwise().reverse());
    for (Eigen::Index i = 0; i < pad; ++i) {
      work.col(pad - 1 - i) = 2.0 * start - work.col(pad + i + 1);
      work.col(pad + n + i) = 2.0 * end - work.col(pad + n - 2 - i);
    }
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
    } else {
      d.row(i) = i == 0 ? (x.row(1) - x.row(0)) / h : (x.row(i) - x.row(i - 1)) / h;
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
