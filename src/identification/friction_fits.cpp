#include "friction_fits.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

namespace knee_robot::identification {
namespace {

constexpr double kSlight = 1e-9;  ///< of a column's own square: stops of nearly equal width are nearly the same column
constexpr double kSteady = 1e-6;  ///< the same, of a law's elements

double sumOf(const Eigen::VectorXd& linear, const std::vector<int>& which, const Eigen::VectorXd& weights) {
  double sum = 0.0;
  for (std::size_t i = 0; i < which.size(); ++i)
    sum += weights[static_cast<Eigen::Index>(i)] * linear[which[i]];
  return sum;
}

double squareOf(const Eigen::MatrixXd& square, const Eigen::VectorXd& own, const std::vector<int>& which,
                const Eigen::VectorXd& weights) {
  double sum = 0.0;
  for (std::size_t i = 0; i < which.size(); ++i) {
    const double w = weights[static_cast<Eigen::Index>(i)];
    for (std::size_t j = 0; j < which.size(); ++j)
      sum += w * weights[static_cast<Eigen::Index>(j)] * (i == j ? own[which[i]] : square(which[i], which[j]));
  }
  return sum;
}

}  // namespace

FrictionBlock& FrictionBlock::operator+=(const FrictionBlock& o) {
  if (base.size() == 0) return *this = o;
  base += o.base;
  mixed += o.mixed;
  candidates += o.candidates;
  own += o.own;
  base_target += o.base_target;
  candidate_target += o.candidate_target;
  target += o.target;
  rows += o.rows;
  return *this;
}

FrictionBlock FrictionBlock::minus(const FrictionBlock& o) const {
  return {base - o.base,
          mixed - o.mixed,
          candidates - o.candidates,
          own - o.own,
          base_target - o.base_target,
          candidate_target - o.candidate_target,
          target - o.target,
          rows - o.rows};
}

double InWeights::at(const std::vector<int>& which, const Eigen::VectorXd& weights) const {
  return constant - 2.0 * sumOf(linear, which, weights) + squareOf(square, own, which, weights);
}

double InWeights::along(const std::vector<int>& which, const Eigen::VectorXd& direction) const {
  return sumOf(linear, which, direction) / std::max(squareOf(square, own, which, direction), 1e-300);
}

double FittedBase::leftOn(const FrictionBlock& other, const std::vector<int>& which,
                          const Eigen::VectorXd& weights) const {
  Eigen::VectorXd base = alone;
  Eigen::VectorXd mixed = Eigen::VectorXd::Zero(alone.size());
  for (std::size_t k = 0; k < which.size(); ++k) {
    const double w = weights[static_cast<Eigen::Index>(k)];
    base -= w * follows.col(which[k]);
    mixed += w * other.mixed.col(which[k]);
  }
  return other.target - 2.0 * sumOf(other.candidate_target, which, weights) +
         squareOf(other.candidates, other.own, which, weights) +
         base.dot(other.base * base + 2.0 * (mixed - other.base_target));
}

FittedBase eliminateBase(const FrictionBlock& fitted, const Eigen::VectorXd& ridge, InWeights& left) {
  Eigen::MatrixXd normal = fitted.base;
  normal.diagonal() += ridge;
  normal.diagonal() *= 1.0 + kSlight;
  const Eigen::LDLT<Eigen::MatrixXd> root(normal);
  const FittedBase base = {root.solve(fitted.base_target), root.solve(fitted.mixed)};
  const Eigen::Index together = fitted.candidates.cols();
  left.constant = fitted.target - fitted.base_target.dot(base.alone);
  left.linear = fitted.candidate_target - base.follows.transpose() * fitted.base_target;
  left.square = fitted.candidates;
  left.square.triangularView<Eigen::Lower>() -=
      fitted.mixed.leftCols(together).transpose() * base.follows.leftCols(together);
  left.square.triangularView<Eigen::StrictlyUpper>() = left.square.transpose();
  left.own = fitted.own - fitted.mixed.cwiseProduct(base.follows).colwise().sum().transpose();
  return base;
}

Eigen::VectorXd positiveWeights(const InWeights& training, const std::vector<int>& which, double least_share) {
  const Eigen::Index n = static_cast<Eigen::Index>(which.size());
  Eigen::MatrixXd a(n, n);
  Eigen::VectorXd b(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    b[i] = training.linear[which[static_cast<std::size_t>(i)]];
    for (Eigen::Index j = 0; j < n; ++j)
      a(i, j) = training.product(which[static_cast<std::size_t>(i)], which[static_cast<std::size_t>(j)]);
    a(i, i) *= 1.0 + kSteady;
  }
  Eigen::VectorXd w;
  if (n == 1) {
    w = Eigen::VectorXd::Constant(1, b[0] / std::max(a(0, 0), 1e-300));
  } else if (n == 2) {
    const double d = a(0, 0) * a(1, 1) - a(0, 1) * a(0, 1);
    w.resize(2);
    w << (b[0] * a(1, 1) - b[1] * a(0, 1)) / d, (b[1] * a(0, 0) - b[0] * a(0, 1)) / d;
  } else {
    w = a.ldlt().solve(b);
  }
  return w.allFinite() && w.minCoeff() > 0.0 && w.minCoeff() >= least_share * w.sum() ? w : Eigen::VectorXd();
}

double leftByPair(const InWeights& training, int first, int second) {
  const double a = training.own[first], c = training.own[second], m = training.square(first, second);
  const double b = training.linear[first], e = training.linear[second];
  const double steady_a = a * (1.0 + kSteady), steady_c = c * (1.0 + kSteady), d = steady_a * steady_c - m * m;
  const double v = (b * steady_c - e * m) / d, w = (e * steady_a - b * m) / d;
  const double least = std::min(v, w);
  if (!(least > 0.0) || least < kLeastOfWeights * (v + w)) return std::numeric_limits<double>::infinity();
  return training.constant - 2.0 * (v * b + w * e) + v * v * a + w * w * c + 2.0 * v * w * m;
}

}  // namespace knee_robot::identification
