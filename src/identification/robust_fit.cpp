#include "knee_robot/identification/robust_fit.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <stdexcept>

namespace knee_robot {
namespace {

constexpr double kHuber = 1.345;  ///< 95 % efficient for normal residuals (Huber 1964)

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// One equation: row * coordinates - target.
class Equation : public ceres::CostFunction {
 public:
  Equation(const double* row, int size, double target) : row_(row), target_(target) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(size);
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const int size = parameter_block_sizes()[0];
    const Eigen::Map<const Eigen::VectorXd> row(row_, size);
    residuals[0] = row.dot(Eigen::Map<const Eigen::VectorXd>(parameters[0], size)) - target_;
    if (jacobians != nullptr && jacobians[0] != nullptr) std::copy(row_, row_ + size, jacobians[0]);
    return true;
  }

 private:
  const double* row_;
  double target_;
};

/// Full (not compressed) equations in the reduction's coordinates.
Rows reducedRows(const Equations& e, const Reduction& r, int rank) {
  const Eigen::Index kept = static_cast<Eigen::Index>(r.kept.size());
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(e.a.cols(), rank);
  for (Eigen::Index i = 0; i < kept; ++i) {
    const int c = r.kept[static_cast<std::size_t>(i)];
    basis(c, i) = 1.0 / r.scale[c];
  }
  for (std::size_t i = 0; i < r.others.size(); ++i) {
    const int c = r.others[i];
    basis.row(c).tail(rank - kept) = r.directions.row(static_cast<Eigen::Index>(i)).head(rank - kept) / r.scale[c];
  }
  return e.a * basis;
}

/// (X'WX)^-1 (sum of g g' over seconds) (X'WX)^-1, with the loss function's weights; coordinates at their bound are fixed.
Eigen::MatrixXd clusterCovariance(const Equations& e, const Rows& x, const Eigen::VectorXd& z, int bounded) {
  const Eigen::Index n = x.cols();
  const Eigen::VectorXd residual = e.b - x * z;
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(n, n);
  std::vector<std::pair<int, Eigen::Index>> order;
  for (Eigen::Index row = 0; row < x.rows(); ++row)
    order.emplace_back(e.second[static_cast<std::size_t>(row)], row);
  std::sort(order.begin(), order.end());
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Eigen::Index row = order[k].second;
    const double weight = std::min(1.0, kHuber / std::max(std::abs(residual[row]), 1e-300));
    normal.selfadjointView<Eigen::Lower>().rankUpdate(x.row(row).transpose(), weight);
    gradient += weight * residual[row] * x.row(row).transpose();
    if (k + 1 == order.size() || order[k + 1].first != order[k].first) {
      meat.noalias() += gradient * gradient.transpose();
      gradient.setZero();
    }
  }
  normal = normal.selfadjointView<Eigen::Lower>();
  for (Eigen::Index i = 0; i < bounded; ++i) {
    if (z[i] > 0.0) continue;
    normal.row(i).setZero();
    normal.col(i).setZero();
    meat.row(i).setZero();
    meat.col(i).setZero();
    normal(i, i) = 1.0;
  }
  const Eigen::MatrixXd inverse = normal.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  return inverse * meat * inverse;
}

}  // namespace

RobustFit robustFit(const Equations& e, const Reduction& r, int rank) {
  const Rows x = reducedRows(e, r, rank);
  RobustFit fit;
  fit.coordinates = solveReduced(r, rank);

  ceres::HuberLoss loss(kHuber);
  ceres::Problem::Options ownership;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  double* const z = fit.coordinates.data();
  problem.AddParameterBlock(z, rank);
  for (Eigen::Index row = 0; row < x.rows(); ++row) {
    problem.AddResidualBlock(new Equation(x.data() + row * x.cols(), rank, e.b[row]), &loss, z);
  }
  for (int i = 0; i < r.minimalRank(); ++i)
    problem.SetParameterLowerBound(z, i, 0.0);

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) throw std::runtime_error("Ceres failed: " + summary.message);

  fit.iterations = static_cast<int>(summary.iterations.size());
  fit.covariance = clusterCovariance(e, x, fit.coordinates, r.minimalRank());
  fit.outlier_share = static_cast<double>(((e.b - x * fit.coordinates).array().abs() > kHuber).count()) / e.rows();
  return fit;
}

}  // namespace knee_robot
