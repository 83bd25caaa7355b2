#include "bootstrap.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "knee_robot/identification/reduction.h"

namespace knee_robot::identification {
namespace {

constexpr int kFewestBlocks = 12;

/// Autocorrelation of one actuator's residual at lags 0 .. most, over pairs of samples that are that far apart in time.
std::vector<double> autocorrelation(const Equations& e, const Eigen::VectorXd& residual, int actuator, int most) {
  std::vector<double> value, time;
  for (int row = 0; row < e.rows(); ++row) {
    if (e.actuator[static_cast<std::size_t>(row)] != actuator) continue;
    value.push_back(residual[row]);
    time.push_back(e.time_s[static_cast<std::size_t>(row)]);
  }
  std::vector<double> sum(static_cast<std::size_t>(most) + 1, 0.0), pairs(sum.size(), 0.0);
  for (std::size_t i = 0; i < value.size(); ++i) {
    for (std::size_t j = i; j < value.size() && j - i <= static_cast<std::size_t>(most); ++j) {
      const std::size_t lag = static_cast<std::size_t>(std::lround((time[j] - time[i]) / e.step_s));
      if (lag > static_cast<std::size_t>(most)) break;
      sum[lag] += value[i] * value[j];
      pairs[lag] += 1.0;
    }
  }
  std::vector<double> rho(sum.size(), 0.0);
  if (pairs[0] == 0.0 || sum[0] == 0.0) return rho;
  for (std::size_t lag = 0; lag < rho.size(); ++lag) {
    if (pairs[lag] > 0.0) rho[lag] = sum[lag] / pairs[lag] / (sum[0] / pairs[0]);
  }
  return rho;
}

/// Block length in samples by Politis and White for `n` samples with this autocorrelation.
double automaticLength(const std::vector<double>& rho, double n) {
  const int quiet = std::max(5, static_cast<int>(std::ceil(std::sqrt(std::log10(n)))));
  const double noise = 2.0 * std::sqrt(std::log10(n) / n);
  const int last = static_cast<int>(rho.size()) - 1;
  int m = last;
  for (int lag = 1, calm = 0; lag <= last; ++lag) {
    calm = std::abs(rho[static_cast<std::size_t>(lag)]) < noise ? calm + 1 : 0;
    if (calm < quiet) continue;
    m = std::max(1, lag - quiet);
    break;
  }
  const int width = std::min(2 * m, last);
  double g0 = 1.0, g1 = 0.0;  // flat-top window: 1 up to half the width, then falling to 0
  for (int lag = 1; lag <= width; ++lag) {
    const double window = std::min(1.0, 2.0 * (1.0 - static_cast<double>(lag) / width));
    g0 += 2.0 * window * rho[static_cast<std::size_t>(lag)];
    g1 += 2.0 * window * lag * rho[static_cast<std::size_t>(lag)];
  }
  g0 = std::max(g0, 0.1);
  return std::cbrt(2.0 * g1 * g1 / (4.0 / 3.0 * g0 * g0) * n);
}

/// Rows in blocks of `block_s`; a block ends with its length or with a file.
std::vector<std::vector<int>> cut(const Equations& e, double block_s) {
  std::map<long, std::vector<int>> blocks;
  for (int row = 0; row < e.rows(); ++row)
    blocks[std::lround(std::floor(e.elapsed_s[static_cast<std::size_t>(row)] / block_s))].push_back(row);
  std::vector<std::vector<int>> list;
  for (auto& [key, rows] : blocks)
    list.push_back(std::move(rows));
  return list;
}

}  // namespace

double bootstrapBlock_s(const Equations& e, const Eigen::VectorXd& residual) {
  const double samples = e.duration_s / e.step_s;
  const double most = std::max(1.0, samples / kFewestBlocks);
  double longest = 1.0;
  for (int i = 0; i < e.axes; ++i) {
    const std::vector<double> rho = autocorrelation(e, residual, i, static_cast<int>(std::min(most, 2000.0)));
    longest = std::max(longest, automaticLength(rho, std::max(10.0, samples)));
  }
  return e.step_s * std::ceil(std::min(longest, most));
}

Bootstrap blockBootstrap(const Equations& e, const Eigen::MatrixXd& x, const Eigen::VectorXd& b, int bounded,
                         double block_s, int draws, unsigned seed, const Eigen::VectorXd& ridge) {
  const Eigen::Index n = x.cols();
  const std::vector<std::vector<int>> blocks = cut(e, block_s);
  Bootstrap result;
  result.block_s = block_s;
  result.blocks = static_cast<int>(blocks.size());
  result.draws.resize(n, draws);

  // In coordinates in which the whole data's normal matrix is 1, sums of squares over blocks lose no accuracy.
  Eigen::MatrixXd whole(x.rows() + ridge.size(), n);
  whole.topRows(x.rows()) = x;
  if (ridge.size() > 0) whole.bottomRows(n) = Eigen::MatrixXd(ridge.cwiseSqrt().asDiagonal());
  const Eigen::MatrixXd triangle = compress(whole, Eigen::VectorXd::Zero(whole.rows()));
  const Eigen::MatrixXd r = triangle.topLeftCorner(n, n);
  std::vector<Eigen::MatrixXd> normal;
  std::vector<Eigen::VectorXd> right;
  for (const std::vector<int>& rows : blocks) {
    const Eigen::MatrixXd own =
        r.transpose().triangularView<Eigen::Lower>().solve(x(rows, Eigen::all).transpose()).transpose();
    normal.push_back(own.transpose() * own);
    right.push_back(own.transpose() * b(rows));
  }
  Eigen::MatrixXd always = Eigen::MatrixXd::Zero(n, n);
  if (ridge.size() > 0) {
    const Eigen::MatrixXd own =
        r.transpose().triangularView<Eigen::Lower>().solve(Eigen::MatrixXd(ridge.cwiseSqrt().asDiagonal())).transpose();
    always = own.transpose() * own;
  }
  std::mt19937 random(seed);
  for (int draw = 0; draw < draws; ++draw) {
    Eigen::MatrixXd sum = always;
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(n);
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      // Exponential by inversion: the standard's distributions differ between libraries, its generators do not.
      const double weight = -std::log((static_cast<double>(random()) + 0.5) / 4294967296.0);
      sum += weight * normal[k];
      pull += weight * right[k];
    }
    const Eigen::LLT<Eigen::MatrixXd> root(sum);
    if (root.info() != Eigen::Success) {
      result.draws.col(draw) = draw > 0 ? result.draws.col(draw - 1).eval() : Eigen::VectorXd::Zero(n);
      continue;
    }
    const Eigen::VectorXd white = root.solve(pull);
    Eigen::VectorXd z = r.triangularView<Eigen::Upper>().solve(white);
    if (bounded > 0 && z.head(bounded).minCoeff() < 0.0) {
      const Eigen::MatrixXd upper = root.matrixU();
      z = boundedLeastSquares(upper * r, upper * white, bounded);
    }
    result.draws.col(draw) = z;
  }
  return result;
}

Eigen::MatrixXd Bootstrap::covariance() const {
  const Eigen::MatrixXd centered = draws.colwise() - draws.rowwise().mean();
  return centered * centered.transpose() / std::max<Eigen::Index>(1, draws.cols() - 1);
}

}  // namespace knee_robot::identification
