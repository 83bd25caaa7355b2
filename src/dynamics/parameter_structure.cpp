#include "knee_robot/dynamics/parameter_structure.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "knee_robot/base/numbers.h"

namespace knee_robot::dynamics {
namespace {

/// Columns that are not in the span of those before them, in the order `preferred` (Gram-Schmidt, twice for its
/// rounding).
std::vector<int> independentColumns(const Eigen::MatrixXd& scaled, const std::vector<int>& preferred,
                                    double tolerance) {
  std::vector<int> chosen;
  Eigen::MatrixXd basis(scaled.rows(), scaled.cols());
  for (const int column : preferred) {
    Eigen::VectorXd rest = scaled.col(column);
    if (rest.norm() == 0.0) continue;
    const auto span = basis.leftCols(static_cast<Eigen::Index>(chosen.size()));
    for (int pass = 0; pass < 2; ++pass)
      rest -= span * (span.transpose() * rest);
    if (rest.norm() <= tolerance) continue;
    basis.col(static_cast<Eigen::Index>(chosen.size())) = rest.normalized();
    chosen.push_back(column);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

/// The same Gram matrix in few rows.
Eigen::MatrixXd triangle(const Eigen::MatrixXd& w) {
  if (w.rows() <= w.cols()) return w;
  return Eigen::HouseholderQR<Eigen::MatrixXd>(w).matrixQR().topRows(w.cols()).triangularView<Eigen::Upper>();
}

}  // namespace

int ParameterStructure::supported(double relative) const {
  if (singular_values.size() == 0) return 0;
  return static_cast<int>((singular_values.array() > relative * singular_values[0]).count());
}

ParameterStructure parameterStructure(const Eigen::MatrixXd& w, double tolerance, const std::vector<int>& preferred) {
  ParameterStructure result;
  const Eigen::Index columns = w.cols();
  Eigen::VectorXd scale = w.colwise().norm().transpose();
  const double largest = scale.maxCoeff();
  Eigen::MatrixXd scaled = triangle(w);
  for (int j = 0; j < columns; ++j) {
    const bool null = !(scale[j] > 1e-12 * largest);
    if (null) result.null_columns.push_back(j);
    if (null) scale[j] = 0.0;
    scaled.col(j) *= null ? 0.0 : 1.0 / scale[j];
  }
  result.singular_values = Eigen::JacobiSVD<Eigen::MatrixXd>(scaled).singularValues();
  result.rank = result.supported(tolerance);

  std::vector<int> order = preferred;
  if (order.empty()) {
    order.resize(columns);
    std::iota(order.rbegin(), order.rend(), 0);
  }
  result.base = independentColumns(scaled, order, std::sqrt(tolerance));
  const int count = static_cast<int>(result.base.size());
  Eigen::MatrixXd kept(scaled.rows(), count);
  for (int k = 0; k < count; ++k)
    kept.col(k) = scaled.col(result.base[k]);
  result.lumping = Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(kept).solve(scaled);
  for (int k = 0; k < count; ++k) {
    for (int j = 0; j < columns; ++j)
      result.lumping(k, j) *= scale[j] / scale[result.base[k]];
  }
  for (int k = 0; k < count; ++k)
    result.lumping.col(result.base[k]).setZero();
  return result;
}

std::string combinationText(const ParameterStructure& structure, int k, const std::vector<std::string>& names) {
  constexpr double kNegligible = 1e-6;
  std::string text = names[structure.base[k]];
  for (int j = 0; j < structure.lumping.cols(); ++j) {
    const double factor = structure.lumping(k, j);
    if (std::abs(factor) < kNegligible) continue;
    text += factor < 0 ? " - " : " + ";
    if (std::abs(std::abs(factor) - 1.0) > kNegligible) text += shortNumber(std::abs(factor), 5) + " ";
    text += names[j];
  }
  return text;
}

int distinguishable(const Eigen::MatrixXd& w, const Eigen::VectorXd& typical, double noise_N) {
  const Eigen::MatrixXd forces = triangle(w) * typical.asDiagonal();
  const Eigen::VectorXd values = Eigen::JacobiSVD<Eigen::MatrixXd>(forces).singularValues();
  return static_cast<int>((values.array() > noise_N * std::sqrt(double(w.rows()))).count());
}

Eigen::MatrixXd observationMatrix(const mechanism::Mechanism& mechanism, const mechanism::Vector3& gravity,
                                  const std::vector<mechanism::Motion>& motions) {
  Eigen::MatrixXd w(4 * motions.size(), kPaperParameters);
  RegressorData data;
  Eigen::Index row = 0;
  for (const mechanism::Motion& motion : motions) {
    if (!projectedRegressor(mechanism, gravity, motion, data)) continue;
    w.middleRows<4>(row) = data.k;
    row += 4;
  }
  return w.topRows(row);
}

}  // namespace knee_robot::dynamics
