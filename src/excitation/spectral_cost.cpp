#include "spectral_cost.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace knee_robot::excitation {
namespace {

constexpr double kEmptyColumn = 1e-24;  ///< squared norm, as share of the largest, below which a column counts as zero
constexpr double kNoDirection = 1e-13;  ///< singular value, as share of the largest, below which it is rounding

Eigen::MatrixXd stacked(const std::vector<PaperRegressor>& observations) {
  Eigen::MatrixXd all(4 * static_cast<Eigen::Index>(observations.size()), dynamics::kPaperParameters);
  for (std::size_t t = 0; t < observations.size(); ++t)
    all.middleRows<4>(4 * static_cast<Eigen::Index>(t)) = observations[t];
  return all;
}

/// 1 / norm of each column; 0 for empty ones.
Eigen::VectorXd scaleOf(const Eigen::VectorXd& squared_norms) {
  const double largest = squared_norms.maxCoeff();
  return squared_norms.unaryExpr([largest](double s) { return s > kEmptyColumn * largest ? 1.0 / std::sqrt(s) : 0.0; });
}

double conditionAt(const Eigen::VectorXd& singular_values, int directions) {
  if (directions > singular_values.size()) return std::numeric_limits<double>::infinity();
  const double first = singular_values[0], last = singular_values[directions - 1];
  return last > kNoDirection * first ? first / last : std::numeric_limits<double>::infinity();
}

}  // namespace

Eigen::VectorXd columnScales(const std::vector<PaperRegressor>& observations) {
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(dynamics::kPaperParameters);
  for (const PaperRegressor& observation : observations)
    squares += observation.colwise().squaredNorm().transpose();
  return scaleOf(squares);
}

SpectralCost::SpectralCost(const std::vector<PaperRegressor>& observations, int directions,
                           ExcitationCriterion criterion, double exponent, const Eigen::VectorXd& fixed_scale) {
  const bool by_condition = criterion == ExcitationCriterion::Condition;
  const Eigen::VectorXd scale = by_condition ? columnScales(observations) : fixed_scale;
  // Columns without effect are left out: eigenvalue problems grow with the cube.
  std::vector<int> used;
  for (int k = 0; k < dynamics::kPaperParameters; ++k) {
    if (scale[k] > 0.0) used.push_back(k);
  }
  const Eigen::VectorXd used_scale = scale(used);
  const Eigen::MatrixXd all = stacked(observations)(Eigen::all, used) * used_scale.asDiagonal();
  const Eigen::Index n = all.cols(), r = std::min<Eigen::Index>(directions, n);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(n, n);
  gram.selfadjointView<Eigen::Lower>().rankUpdate(all.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);  // reads the lower triangle, ascending eigenvalues
  const Eigen::MatrixXd v = eigen.eigenvectors().rightCols(r);
  const Eigen::ArrayXd l = eigen.eigenvalues().tail(r).array().max(1e-16 * eigen.eigenvalues()[n - 1]);

  Eigen::ArrayXd by_eigenvalue = Eigen::ArrayXd::Zero(r);  // d(value)/d(l_i)
  if (!by_condition) {
    const double half = 0.5 / static_cast<double>(r);
    value_ = -half * l.log().sum();
    by_eigenvalue = -half / l;
  } else if (exponent > 0.0) {
    const double p = exponent;
    const Eigen::ArrayXd up = (l / l[r - 1]).pow(p), down = (l / l[0]).pow(-p);  // both at most 1
    value_ = 0.5 * (std::log(l[r - 1] / l[0]) + (std::log(up.sum()) + std::log(down.sum())) / p);
    by_eigenvalue = 0.5 * (up / up.sum() - down / down.sum()) / l;
  } else {
    value_ = 0.5 * std::log(l[r - 1] / l[0]);
    by_eigenvalue[r - 1] += 0.5 / l[r - 1];
    by_eigenvalue[0] -= 0.5 / l[0];
  }
  // With G = D S D, G v = l v, y = D v: dl = 2 sum_t [(W_t y)^T dW_t y - l sum_i v_i^2/S_ii W_ti^T dW_ti], the second
  // part only when D follows S.
  const Eigen::MatrixXd y = used_scale.asDiagonal() * v;
  Eigen::MatrixXd slope = 2.0 * y * by_eigenvalue.matrix().asDiagonal() * y.transpose();
  if (by_condition) slope.diagonal() -= 2.0 * y.array().square().matrix() * (by_eigenvalue * l).matrix();
  slope_ = Eigen::MatrixXd::Zero(dynamics::kPaperParameters, dynamics::kPaperParameters);
  slope_(used, used) = slope;
}

std::vector<ConditionAt> conditionsOf(const std::vector<PaperRegressor>& observations,
                                      const std::vector<int>& directions) {
  const Eigen::MatrixXd all = stacked(observations);
  // The triangular factor has the singular values of the whole; Jacobi resolves the small ones.
  const auto singularValues = [](const Eigen::MatrixXd& matrix) -> Eigen::VectorXd {
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix);
    const Eigen::Index n = std::min(matrix.rows(), matrix.cols());
    const Eigen::MatrixXd triangle = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>();
    return Eigen::JacobiSVD<Eigen::MatrixXd>(triangle).singularValues();
  };
  const Eigen::VectorXd scale = columnScales(observations);
  const Eigen::VectorXd scaled = singularValues(all * scale.asDiagonal()), raw = singularValues(all);
  std::vector<ConditionAt> result;
  result.reserve(directions.size());
  for (const int r : directions)
    result.push_back({r, conditionAt(scaled, r), conditionAt(raw, r)});
  return result;
}

}  // namespace knee_robot::excitation
