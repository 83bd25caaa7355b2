#include "friction_fits.h"

#include <Eigen/Cholesky>

namespace knee_robot::identification {
namespace {

constexpr double kSlight = 1e-9;  ///< of a column's own square: stops of nearly equal width are nearly the same column

}  // namespace

FrictionBlock& FrictionBlock::operator+=(const FrictionBlock& o) {
  if (base.size() == 0) return *this = o;
  base += o.base;
  mixed += o.mixed;
  candidates += o.candidates;
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
          base_target - o.base_target,
          candidate_target - o.candidate_target,
          target - o.target,
          rows - o.rows};
}

double InWeights::at(const std::vector<int>& which, const Eigen::VectorXd& weights) const {
  double sum = constant;
  for (std::size_t i = 0; i < which.size(); ++i) {
    const double w = weights[static_cast<Eigen::Index>(i)];
    sum -= 2.0 * w * linear[which[i]];
    for (std::size_t j = 0; j < which.size(); ++j)
      sum += w * weights[static_cast<Eigen::Index>(j)] * square(which[i], which[j]);
  }
  return sum;
}

void eliminateBase(const FrictionBlock& fitted, const FrictionBlock& other, const Eigen::VectorXd& ridge,
                   InWeights& training, InWeights& held_back) {
  Eigen::MatrixXd normal = fitted.base;
  normal.diagonal() += ridge;
  normal.diagonal() *= 1.0 + kSlight;
  const Eigen::LDLT<Eigen::MatrixXd> root(normal);
  const Eigen::VectorXd alone = root.solve(fitted.base_target);
  const Eigen::MatrixXd follows = root.solve(fitted.mixed);  // base = alone - follows * w
  training.constant = fitted.target - fitted.base_target.dot(alone);
  training.linear = fitted.candidate_target - follows.transpose() * fitted.base_target;
  training.square = fitted.candidates - fitted.mixed.transpose() * follows;
  const Eigen::MatrixXd seen = other.base * follows;
  held_back.constant = other.target - 2.0 * other.base_target.dot(alone) + alone.dot(other.base * alone);
  held_back.linear = other.candidate_target - follows.transpose() * other.base_target -
                     other.mixed.transpose() * alone + seen.transpose() * alone;
  held_back.square = other.candidates - other.mixed.transpose() * follows - follows.transpose() * other.mixed +
                     follows.transpose() * seen;
}

Eigen::VectorXd positiveWeights(const InWeights& training, const std::vector<int>& which, double least_share) {
  const Eigen::Index n = static_cast<Eigen::Index>(which.size());
  Eigen::MatrixXd a(n, n);
  Eigen::VectorXd b(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    b[i] = training.linear[which[static_cast<std::size_t>(i)]];
    for (Eigen::Index j = 0; j < n; ++j)
      a(i, j) = training.square(which[static_cast<std::size_t>(i)], which[static_cast<std::size_t>(j)]);
    a(i, i) *= 1.0 + 1e3 * kSlight;
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

}  // namespace knee_robot::identification
