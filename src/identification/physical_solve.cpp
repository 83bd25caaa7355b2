#include <ceres/ceres.h>

#include <Eigen/QR>
#include <stdexcept>

#include "knee_robot/identification/physical_problem.h"

namespace knee_robot {
namespace {

constexpr int kPerLink = PhysicalCoordinates::kPerLink;
constexpr double kSmallestLog = -8.0;  ///< of the diagonal of U
constexpr double kLargestLog = 5.0;

/// Coordinates of E = U U^T. x: logarithms of U's diagonal, then its upper triangle row by row; all zero: E = 1.
template <typename T>
void coordinatesOfRoot(const T* x, T* e) {
  using std::exp;
  T u[4][4];
  int k = 4;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column)
      u[row][column] = column < row ? T(0.0) : column == row ? T(exp(x[row])) : x[k++];
  }
  k = 4;
  for (int row = 0; row < 4; ++row) {
    for (int column = row; column < 4; ++column) {
      T sum(0.0);
      for (int i = column; i < 4; ++i)
        sum += u[row][i] * u[column][i];
      if (column == row) {
        e[row] = sum;
      } else {
        e[k++] = M_SQRT2 * sum;
      }
    }
  }
}

/// rows * [coordinates(roots); free] - target; parameter blocks: nine links, then the free columns.
class Residuals : public ceres::CostFunction {
 public:
  Residuals(Eigen::MatrixXd rows, Eigen::VectorXd target, int free)
      : rows_(std::move(rows)), target_(std::move(target)), free_(free) {
    set_num_residuals(static_cast<int>(target_.size()));
    for (int link = 0; link < kLinks; ++link)
      mutable_parameter_block_sizes()->push_back(kPerLink);
    if (free_ > 0) mutable_parameter_block_sizes()->push_back(free_);
  }

  bool Evaluate(const double* const* x, double* residuals, double** jacobians) const override {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::VectorXd z(rows_.cols());
    for (int link = 0; link < kLinks; ++link) {
      coordinatesOfRoot(x[link], z.data() + link * kPerLink);
      if (jacobians == nullptr || jacobians[link] == nullptr) continue;
      Eigen::Map<RowMajor>(jacobians[link], rows_.rows(), kPerLink).noalias() =
          rows_.middleCols<kPerLink>(link * kPerLink) * derivative(x[link]);
    }
    if (free_ > 0) {
      z.tail(free_) = Eigen::Map<const Eigen::VectorXd>(x[kLinks], free_);
      if (jacobians != nullptr && jacobians[kLinks] != nullptr)
        Eigen::Map<RowMajor>(jacobians[kLinks], rows_.rows(), free_) = rows_.rightCols(free_);
    }
    Eigen::Map<Eigen::VectorXd>(residuals, target_.size()) = rows_ * z - target_;
    return true;
  }

 private:
  static Eigen::Matrix<double, kPerLink, kPerLink> derivative(const double* x) {
    using Jet = ceres::Jet<double, kPerLink>;
    Jet in[kPerLink], out[kPerLink];
    for (int k = 0; k < kPerLink; ++k)
      in[k] = Jet(x[k], k);
    coordinatesOfRoot(in, out);
    Eigen::Matrix<double, kPerLink, kPerLink> d;
    for (int k = 0; k < kPerLink; ++k)
      d.row(k) = out[k].v.transpose();
    return d;
  }

  Eigen::MatrixXd rows_;
  Eigen::VectorXd target_;
  int free_;
};

/// Data and prior as one least-squares problem in few rows; columns of free parameters scaled to unit size.
struct Stacked {
  Eigen::MatrixXd rows;
  Eigen::VectorXd target;
  Eigen::VectorXd free_scale;
  double left = 0.0;  ///< sum of squares that no parameter can change
};

Stacked stack(const PhysicalProblem& p, const PriorPull& pull) {
  const Eigen::Index n = p.data.cols();
  const Eigen::Index m = p.data.rows() + pull.root.rows();
  Eigen::MatrixXd all(m, n + 1);
  all.topLeftCorner(p.data.rows(), n) = p.data;
  all.bottomLeftCorner(pull.root.rows(), n) = pull.root;
  all.col(n).head(p.data.rows()) = p.target;
  all.col(n).tail(pull.root.rows()) = pull.root * pull.mean;
  Stacked s;
  s.free_scale = all.middleCols(n - p.free_size.size(), p.free_size.size()).colwise().norm().transpose();
  for (double& scale : s.free_scale)
    scale = scale > 0.0 ? 1.0 / scale : 0.0;  // zero: the column does not occur and the parameter stays zero
  all.middleCols(n - p.free_size.size(), p.free_size.size()) *= s.free_scale.asDiagonal();
  const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(all);
  const Eigen::MatrixXd triangle = all.topRows(std::min(m, n + 1)).triangularView<Eigen::Upper>();
  s.rows = triangle.topLeftCorner(std::min(m, n), n);
  s.target = triangle.col(n).head(s.rows.rows());
  s.left = m > n ? triangle(n, n) * triangle(n, n) : 0.0;
  return s;
}

}  // namespace

PhysicalSolution solvePhysical(const PhysicalProblem& p, const PriorPull& pull) {
  const Stacked s = stack(p, pull);
  const int free = static_cast<int>(p.free.size());
  Eigen::VectorXd x = Eigen::VectorXd::Zero(kLinks * kPerLink + free);
  std::vector<double*> blocks;
  for (int link = 0; link < kLinks; ++link)
    blocks.push_back(x.data() + link * kPerLink);
  if (free > 0) blocks.push_back(x.data() + kLinks * kPerLink);

  ceres::Problem problem;
  problem.AddResidualBlock(new Residuals(s.rows, s.target, free), nullptr, blocks);
  for (int link = 0; link < kLinks; ++link) {
    for (int k = 0; k < 4; ++k) {
      problem.SetParameterLowerBound(blocks[static_cast<std::size_t>(link)], k, kSmallestLog);
      problem.SetParameterUpperBound(blocks[static_cast<std::size_t>(link)], k, kLargestLog);
    }
  }
  for (int i = 0; i < free; ++i) {
    if (p.nonnegative[static_cast<std::size_t>(i)]) problem.SetParameterLowerBound(blocks.back(), i, 0.0);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 300;
  options.function_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) throw std::runtime_error("Ceres failed: " + summary.message);

  PhysicalSolution solution;
  solution.inertial.resize(kLinks * kPerLink);
  for (int link = 0; link < kLinks; ++link)
    coordinatesOfRoot(x.data() + link * kPerLink, solution.inertial.data() + link * kPerLink);
  solution.free = x.tail(free).cwiseProduct(s.free_scale);
  solution.cost = 2.0 * summary.final_cost + s.left;
  solution.iterations = static_cast<int>(summary.iterations.size());
  return solution;
}

}  // namespace knee_robot
