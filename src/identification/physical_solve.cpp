#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "knee_robot/identification/physical_problem.h"

namespace knee_robot::identification {
namespace {

constexpr int kPerLink = PhysicalCoordinates::kPerLink;
constexpr double kSmallestLog = -8.0;  ///< of the diagonal of U
constexpr double kLargestLog = 5.0;
constexpr double kOptimal = 1e-6;  ///< of the cost: what a change of one body may still gain at an optimum
constexpr int kPushes = 30;

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

/// rows * [coordinates(roots); free] - target; parameter blocks: the links, then the free columns.
class Residuals : public ceres::CostFunction {
 public:
  Residuals(Eigen::MatrixXd rows, Eigen::VectorXd target, int free)
      : rows_(std::move(rows)),
        target_(std::move(target)),
        free_(free),
        links_((static_cast<int>(rows_.cols()) - free) / kPerLink) {
    set_num_residuals(static_cast<int>(target_.size()));
    for (int link = 0; link < links_; ++link)
      mutable_parameter_block_sizes()->push_back(kPerLink);
    if (free_ > 0) mutable_parameter_block_sizes()->push_back(free_);
  }

  bool Evaluate(const double* const* x, double* residuals, double** jacobians) const override {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::VectorXd z(rows_.cols());
    for (int link = 0; link < links_; ++link) {
      coordinatesOfRoot(x[link], z.data() + link * kPerLink);
      if (jacobians == nullptr || jacobians[link] == nullptr) continue;
      Eigen::Map<RowMajor>(jacobians[link], rows_.rows(), kPerLink).noalias() =
          rows_.middleCols<kPerLink>(link * kPerLink) * derivative(x[link]);
    }
    if (free_ > 0) {
      z.tail(free_) = Eigen::Map<const Eigen::VectorXd>(x[links_], free_);
      if (jacobians != nullptr && jacobians[links_] != nullptr)
        Eigen::Map<RowMajor>(jacobians[links_], rows_.rows(), free_) = rows_.rightCols(free_);
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
  int free_, links_;
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

using Coordinates = Eigen::Matrix<double, kPerLink, 1>;

/// The symmetric matrix with these coordinates.
Eigen::Matrix4d matrixOf(const Eigen::Ref<const Coordinates>& c) {
  Eigen::Matrix4d e = c.head<4>().asDiagonal();
  int k = 4;
  for (int row = 0; row < 4; ++row) {
    for (int column = row + 1; column < 4; ++column)
      e(row, column) = e(column, row) = c[k++] * M_SQRT1_2;
  }
  return e;
}

Coordinates coordinatesOf(const Eigen::Matrix4d& e) {
  Coordinates c;
  c.head<4>() = e.diagonal();
  int k = 4;
  for (int row = 0; row < 4; ++row) {
    for (int column = row + 1; column < 4; ++column)
      c[k++] = M_SQRT2 * e(row, column);
  }
  return c;
}

/// Root coordinates x of E (see coordinatesOfRoot): Cholesky from the last row up.
void rootOfMatrix(const Eigen::Matrix4d& e, double* x) {
  const Eigen::Matrix4d lower = e.reverse().eval().llt().matrixL();
  const Eigen::Matrix4d u = lower.reverse();
  int k = 4;
  for (int row = 0; row < 4; ++row) {
    x[row] = std::clamp(std::log(std::max(u(row, row), 1e-300)), kSmallestLog, kLargestLog);
    for (int column = row + 1; column < 4; ++column)
      x[k++] = u(row, column);
  }
}

/// All unknowns: the links' roots, then the free columns (scaled).
struct BodyUnknowns {
  Eigen::VectorXd x;
  int links = 0;
  double* root(int link) { return x.data() + link * kPerLink; }
  double* free() { return x.data() + links * kPerLink; }

  Eigen::VectorXd coordinates() const {
    Eigen::VectorXd z = x;
    for (int link = 0; link < links; ++link)
      coordinatesOfRoot(x.data() + link * kPerLink, z.data() + link * kPerLink);
    return z;
  }
};

/// Ceres from where the unknowns are. Returns its iterations.
int descend(const PhysicalProblem& p, const Stacked& s, BodyUnknowns& unknowns) {
  const int free = static_cast<int>(p.free.size());
  std::vector<double*> blocks;
  for (int link = 0; link < unknowns.links; ++link)
    blocks.push_back(unknowns.root(link));
  if (free > 0) blocks.push_back(unknowns.free());
  ceres::Problem problem;
  problem.AddResidualBlock(new Residuals(s.rows, s.target, free), nullptr, blocks);
  for (int link = 0; link < unknowns.links; ++link) {
    for (int k = 0; k < 4; ++k) {
      problem.SetParameterLowerBound(unknowns.root(link), k, kSmallestLog);
      problem.SetParameterUpperBound(unknowns.root(link), k, kLargestLog);
    }
  }
  for (int i = 0; i < free; ++i) {
    if (p.nonnegative[static_cast<std::size_t>(i)]) problem.SetParameterLowerBound(unknowns.free(), i, 0.0);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 300;
  options.function_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) throw std::runtime_error("Ceres failed: " + summary.message);
  return static_cast<int>(summary.iterations.size());
}

/// In the bodies themselves the problem is convex; in their roots it is not: at the boundary of what is possible the
/// slope by a root vanishes although the body would still gain by growing. That body is pushed off: E grows by the
/// multiple of v v^T, v the lowest eigenvector of the cost's slope, that gains most. Returns what all pushes gained;
/// when no body gains, the point is the optimum.
double push(const Stacked& s, BodyUnknowns& unknowns) {
  Eigen::VectorXd z = unknowns.coordinates();
  Eigen::VectorXd residual = s.rows * z - s.target;
  double gained = 0.0;
  for (int link = 0; link < unknowns.links; ++link) {
    const auto rows = s.rows.middleCols<kPerLink>(link * kPerLink);
    const Coordinates slope = 2.0 * rows.transpose() * residual;
    // <G, dE> = slope . d(coordinates), and the coordinates are an isometry.
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(matrixOf(slope));
    const double lowest = eigen.eigenvalues()[0];
    if (lowest >= 0.0) continue;
    const Eigen::Vector4d v = eigen.eigenvectors().col(0);
    const Eigen::Matrix4d outer = v * v.transpose();
    const Eigen::VectorXd moved = rows * coordinatesOf(outer);
    const double curvature = moved.squaredNorm();
    const double gain = curvature > 0.0 ? lowest * lowest / (4.0 * curvature) : 0.0;
    if (gain <= kOptimal * (residual.squaredNorm() + s.left)) continue;
    const double step = -lowest / (2.0 * curvature);
    residual += step * moved;
    gained += gain;
    rootOfMatrix(matrixOf(z.segment<kPerLink>(link * kPerLink)) + step * outer, unknowns.root(link));
  }
  return gained;
}

}  // namespace

PhysicalSolution solvePhysical(const PhysicalProblem& p, const PriorPull& pull) {
  const Stacked s = stack(p, pull);
  const Eigen::Index inertial = s.rows.cols() - static_cast<Eigen::Index>(p.free.size());
  BodyUnknowns unknowns{Eigen::VectorXd::Zero(s.rows.cols()), static_cast<int>(inertial) / kPerLink};
  PhysicalSolution solution;
  solution.iterations = descend(p, s, unknowns);
  BodyUnknowns pushed = unknowns;
  solution.optimal = push(s, pushed) == 0.0;
  while (!solution.optimal && solution.pushes < kPushes) {
    ++solution.pushes;
    solution.iterations += descend(p, s, pushed);
    unknowns = pushed;
    solution.optimal = push(s, pushed) == 0.0;
  }
  const Eigen::VectorXd z = unknowns.coordinates();
  solution.inertial = z.head(inertial);
  solution.free = z.tail(s.free_scale.size()).cwiseProduct(s.free_scale);
  solution.cost = (s.rows * z - s.target).squaredNorm() + s.left;
  return solution;
}

}  // namespace knee_robot::identification
