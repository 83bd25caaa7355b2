#include "knee_robot/recording/filter.h"

#include <algorithm>
#include <cmath>

namespace knee_robot {

ZeroPhaseLowPass::ZeroPhaseLowPass(double cutoff_hz, double rate_hz) {
  if (!(cutoff_hz > 0.0) || cutoff_hz >= 0.45 * rate_hz) return;
  active_ = true;
  padding_ = static_cast<int>(std::ceil(6.0 * rate_hz / cutoff_hz));
  edge_ = static_cast<int>(std::ceil(rate_hz / cutoff_hz));
  // Bilinear transform with the cut-off prewarped; the two pole pairs of the 4th-order Butterworth have these quality factors.
  const double k = std::tan(M_PI * cutoff_hz / rate_hz);
  for (int s = 0; s < 2; ++s) {
    const double q = 1.0 / (2.0 * std::cos(M_PI / 8.0 * (1 + 2 * s)));
    const double norm = 1.0 / (1.0 + k / q + k * k);
    const double b0 = k * k * norm;
    sections_[s] = {b0, 2.0 * b0, b0, 2.0 * (k * k - 1.0) * norm, (1.0 - k / q + k * k) * norm};
  }
}

/// Forward pass in place, transposed direct form II, each section started in its steady state for the first value.
void ZeroPhaseLowPass::run(Eigen::VectorXd& signal) const {
  for (const Section& s : sections_) {
    const double first = signal[0];
    double z2 = (s.b2 - s.a2) * first;  // the gain at zero frequency is one: output = input = first
    double z1 = (s.b1 - s.a1) * first + z2;
    for (double& value : signal) {
      const double in = value;
      const double out = s.b0 * in + z1;
      z1 = s.b1 * in - s.a1 * out + z2;
      z2 = s.b2 * in - s.a2 * out;
      value = out;
    }
  }
}

void ZeroPhaseLowPass::apply(Eigen::Ref<Eigen::VectorXd> signal) const {
  const Eigen::Index n = signal.size();
  if (!active_ || n < 2) return;
  const Eigen::Index pad = std::min<Eigen::Index>(padding_, n - 1);
  Eigen::VectorXd work(n + 2 * pad);
  for (Eigen::Index i = 0; i < pad; ++i) {
    work[pad - 1 - i] = 2.0 * signal[0] - signal[i + 1];
    work[pad + n + i] = 2.0 * signal[n - 1] - signal[n - 2 - i];
  }
  work.segment(pad, n) = signal;
  run(work);
  work.reverseInPlace();
  run(work);
  signal = work.segment(pad, n).reverse();
}

void ZeroPhaseLowPass::applyToColumns(Eigen::MatrixXd& signals) const {
  for (Eigen::Index i = 0; i < signals.cols(); ++i)
    apply(signals.col(i));
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

}  // namespace knee_robot
