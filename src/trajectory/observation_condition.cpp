#include "observation_condition.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <limits>

namespace knee_robot {
namespace {

constexpr double kEmptyColumn = 1e-24;  ///< squared norm, as share of the largest, below which a column counts as zero
constexpr double kNoDirection = 1e-13;  ///< singular value, as share of the largest, below which it is rounding

Eigen::MatrixXd stacked(const std::vector<PaperRegressor>& observations) {
  Eigen::MatrixXd all(4 * static_cast<Eigen::Index>(observations.size()), kPaperParameters);
  for (std::size_t t = 0; t < observations.size(); ++t)
    all.middleRows<4>(4 * static_cast<Eigen::Index>(t)) = observations[t];
  return all;
}

/// 1 / norm of each column; 0 for empty ones.
Eigen::VectorXd columnScale(const Eigen::VectorXd& squared_norms) {
  const double largest = squared_norms.maxCoeff();
  return squared_norms.unaryExpr([largest](double s) { return s > kEmptyColumn * largest ? 1.0 / std::sqrt(s) : 0.0; });
}

double conditionAt(const Eigen::VectorXd& singular_values, int directions) {
  if (directions > singular_values.size()) return std::numeric_limits<double>::infinity();
  const double first = singular_values[0], last = singular_values[directions - 1];
  return last > kNoDirection * first ? first / last : std::numeric_limits<double>::infinity();
}

}  // namespace

LogCondition::LogCondition(const std::vector<PaperRegressor>& observations, int directions) {
  const Eigen::MatrixXd all = stacked(observations);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(kPaperParameters, kPaperParameters);
  gram.selfadjointView<Eigen::Lower>().rankUpdate(all.transpose());
  const Eigen::VectorXd norms = gram.diagonal();
  const Eigen::VectorXd scale = columnScale(norms);
  gram.triangularView<Eigen::Lower>() = scale.asDiagonal() * gram * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);  // reads the lower triangle, ascending eigenvalues
  const auto direction = [&](Eigen::Index column) {
    Direction d;
    const Eigen::VectorXd v = eigen.eigenvectors().col(column);
    d.unscaled = scale.cwiseProduct(v);
    d.weights = d.unscaled.cwiseProduct(d.unscaled);
    d.eigenvalue = std::max(eigen.eigenvalues()[column], 1e-16 * eigen.eigenvalues()[kPaperParameters - 1]);
    return d;
  };
  largest_ = direction(kPaperParameters - 1);
  smallest_ = direction(kPaperParameters - directions);
  value_ = 0.5 * std::log(largest_.eigenvalue / smallest_.eigenvalue);
}

PaperRegressor LogCondition::gradient(const PaperRegressor& observation) const {
  // With G_ij = S_ij / sqrt(S_ii S_jj), G v = l v, y = D v: dl = 2 sum_t [(W_t y)^T dW_t y - l sum_i v_i^2/S_ii W_ti^T dW_ti].
  const auto part = [&](const Direction& d) -> PaperRegressor {
    const Vector4 along = observation * d.unscaled;
    return along * d.unscaled.transpose() / d.eigenvalue - observation * d.weights.asDiagonal();
  };
  return part(largest_) - part(smallest_);
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
  const Eigen::VectorXd scale = columnScale(all.colwise().squaredNorm().transpose());
  const Eigen::VectorXd scaled = singularValues(all * scale.asDiagonal()), raw = singularValues(all);
  std::vector<ConditionAt> result;
  result.reserve(directions.size());
  for (const int r : directions)
    result.push_back({r, conditionAt(scaled, r), conditionAt(raw, r)});
  return result;
}

}  // namespace knee_robot
