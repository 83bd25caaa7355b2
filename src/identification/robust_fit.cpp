#include "knee_robot/identification/robust_fit.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bootstrap.h"
#include "knee_robot/base/quantile.h"

namespace knee_robot::identification {
namespace {

constexpr double kHuber = 1.345;     ///< 95 % efficient for normal residuals (Huber 1964)
constexpr double kBisquare = 4.685;  ///< the same (Beaton and Tukey 1974)
constexpr int kMostReweightings = 50;
constexpr double kSurelyInside = 0.8;  ///< of the quadratic part

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int kChunk = 256;  ///< equations a residual block: each block has a fixed cost in Ceres

/// Some equations; with Huber's loss as a least-squares problem: root(rho(r^2)) with the sign of r, whose square is the
/// loss.
class EquationChunk : public ceres::CostFunction {
 public:
  EquationChunk(const double* rows, const double* targets, int count, int size, bool huber)
      : rows_(rows), targets_(targets), count_(count), huber_(huber) {
    set_num_residuals(count);
    mutable_parameter_block_sizes()->push_back(size);
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const int size = parameter_block_sizes()[0];
    const Eigen::Map<const Rows> rows(rows_, count_, size);
    Eigen::Map<Eigen::VectorXd> out(residuals, count_);
    out.noalias() = rows * Eigen::Map<const Eigen::VectorXd>(parameters[0], size);
    out -= Eigen::Map<const Eigen::VectorXd>(targets_, count_);
    Eigen::VectorXd slope = Eigen::VectorXd::Ones(count_);
    for (int i = 0; huber_ && i < count_; ++i) {
      const double linear = std::abs(out[i]);
      if (linear <= kHuber) continue;
      const double root = std::sqrt(2.0 * kHuber * linear - kHuber * kHuber);
      slope[i] = kHuber / root;
      out[i] = std::copysign(root, out[i]);
    }
    if (jacobians != nullptr && jacobians[0] != nullptr)
      Eigen::Map<Rows>(jacobians[0], count_, size).noalias() = slope.asDiagonal() * rows;
    return true;
  }

 private:
  const double* rows_;
  const double* targets_;
  int count_;
  bool huber_;
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

/// The prior's pull as further equations.
Rows pulled(const Rows& x, const Eigen::VectorXd& ridge) {
  Rows more(x.rows() + ridge.size(), x.cols());
  more.topRows(x.rows()) = x;
  more.bottomRows(ridge.size()) = Eigen::MatrixXd(ridge.cwiseSqrt().asDiagonal());
  return more;
}

Eigen::VectorXd padded(const Eigen::VectorXd& b, const Eigen::VectorXd& ridge) {
  Eigen::VectorXd more = Eigen::VectorXd::Zero(b.size() + ridge.size());
  more.head(b.size()) = b;
  return more;
}

/// The least-squares part of a Huber problem in few rows, and the equations that may be in its linear part.
struct HuberParts {
  Rows square;  ///< triangle of the equations well within the quadratic part
  Eigen::VectorXd square_target;
  Rows rest;
  Eigen::VectorXd rest_target;
  std::vector<Eigen::Index> squared;  ///< rows that went into the triangle
};

HuberParts splitHuber(const Rows& x, const Eigen::VectorXd& b, const std::vector<char>& inside,
                      const Eigen::VectorXd& ridge) {
  HuberParts parts;
  std::vector<Eigen::Index> rest;
  for (Eigen::Index row = 0; row < x.rows(); ++row)
    (inside[static_cast<std::size_t>(row)] ? parts.squared : rest).push_back(row);
  const Eigen::MatrixXd triangle =
      compress(pulled(x(parts.squared, Eigen::all), ridge), padded(b(parts.squared), ridge));
  parts.square = triangle.leftCols(x.cols());
  parts.square_target = triangle.col(x.cols());
  parts.rest = x(rest, Eigen::all);
  parts.rest_target = b(rest);
  return parts;
}

int solveHuber(const HuberParts& parts, int bounded, Eigen::VectorXd& coordinates) {
  ceres::Problem problem;
  double* const z = coordinates.data();
  const int size = static_cast<int>(coordinates.size());
  problem.AddParameterBlock(z, size);
  problem.AddResidualBlock(new EquationChunk(parts.square.data(), parts.square_target.data(),
                                             static_cast<int>(parts.square.rows()), size, false),
                           nullptr, z);
  for (Eigen::Index row = 0; row < parts.rest.rows(); row += kChunk) {
    const int count = static_cast<int>(std::min<Eigen::Index>(kChunk, parts.rest.rows() - row));
    problem.AddResidualBlock(
        new EquationChunk(parts.rest.data() + row * size, parts.rest_target.data() + row, count, size, true), nullptr,
        z);
  }
  for (int i = 0; i < bounded; ++i)
    problem.SetParameterLowerBound(z, i, 0.0);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) throw std::runtime_error("Ceres failed: " + summary.message);
  return static_cast<int>(summary.iterations.size());
}

/// Huber's loss by Ceres, from a good start. Equations well within the quadratic part are compressed first; when one of
/// them leaves it after all, it joins the others and the fit goes on: the result is that of all equations.
int fitHuber(const Rows& x, const Eigen::VectorXd& b, int bounded, const Eigen::VectorXd& ridge, Eigen::VectorXd& z) {
  std::vector<char> inside(static_cast<std::size_t>(x.rows()), 1);
  Eigen::VectorXd size = (b - x * z).cwiseAbs();
  for (Eigen::Index row = 0; row < x.rows(); ++row)
    inside[static_cast<std::size_t>(row)] = size[row] < kSurelyInside * kHuber;
  int iterations = 0;
  for (int pass = 0; pass < kMostReweightings; ++pass) {
    const HuberParts parts = splitHuber(x, b, inside, ridge);
    iterations += solveHuber(parts, bounded, z);
    size = (b - x * z).cwiseAbs();
    int left = 0;
    for (const Eigen::Index row : parts.squared) {
      if (size[row] <= kHuber) continue;
      inside[static_cast<std::size_t>(row)] = 0;
      ++left;
    }
    if (left == 0) break;
  }
  return iterations;
}

double huberWeight(double residual) {
  return std::abs(residual) <= kHuber ? 1.0 : kHuber / std::abs(residual);
}

double tukeyWeight(double residual) {
  const double share = std::abs(residual) / kBisquare;
  return share >= 1.0 ? 0.0 : (1.0 - share * share) * (1.0 - share * share);
}

/// Residuals in units of a scale that outliers do not reach: per actuator the median of their size over 0.6745.
Eigen::VectorXd standardized(const Equations& e, Eigen::VectorXd residual) {
  for (int i = 0; i < e.axes; ++i) {
    std::vector<double> size;
    for (int row = 0; row < e.rows(); ++row) {
      if (e.actuator[static_cast<std::size_t>(row)] == i) size.push_back(std::abs(residual[row]));
    }
    if (size.empty()) continue;
    const double scale = std::max(median(std::move(size)) / 0.6745, 1e-6);
    for (int row = 0; row < e.rows(); ++row) {
      if (e.actuator[static_cast<std::size_t>(row)] == i) residual[row] /= scale;
    }
  }
  return residual;
}

/// Iteratively reweighted least squares: with Huber's weights first, because Tukey's loss has more than one minimum,
/// then with Tukey's. Returns the weights.
Eigen::VectorXd fitBisquare(const Equations& e, const Rows& x, const Eigen::VectorXd& b, int bounded,
                            const Eigen::VectorXd& ridge, Eigen::VectorXd& z, int& iterations) {
  Eigen::VectorXd weights;
  for (const auto weight : {&huberWeight, &tukeyWeight}) {
    for (int k = 0; k < kMostReweightings; ++k, ++iterations) {
      const Eigen::VectorXd before = z;
      weights = standardized(e, b - x * z).unaryExpr(weight);
      const Eigen::VectorXd root = weights.cwiseSqrt();
      const Eigen::MatrixXd triangle =
          compress(pulled(root.asDiagonal() * x, ridge), padded(root.cwiseProduct(b), ridge));
      z = boundedLeastSquares(triangle.leftCols(x.cols()), triangle.col(x.cols()), bounded);
      if ((z - before).norm() <= 1e-6 * z.norm()) break;
    }
  }
  return weights;
}

}  // namespace

RobustFit robustFit(const Equations& e, const Reduction& r, int rank, OutlierRule rule, double strength,
                    bool uncertainty) {
  const Rows x = reducedRows(e, r, rank);
  const Eigen::VectorXd b = e.b - e.a * r.start;
  const int bounded = r.minimalRank();
  Eigen::VectorXd ridge = Eigen::VectorXd::Zero(rank);
  ridge.tail(rank - bounded).setConstant(strength);
  RobustFit fit;
  fit.coordinates = solveWithPrior(r, rank, strength);
  if (rule == OutlierRule::Huber) fit.iterations = fitHuber(x, b, bounded, ridge, fit.coordinates);
  fit.weights = Eigen::VectorXd::Ones(e.rows());
  if (rule == OutlierRule::Bisquare)
    fit.weights = fitBisquare(e, x, b, bounded, ridge, fit.coordinates, fit.iterations);
  fit.coordinates.head(bounded) = fit.coordinates.head(bounded).cwiseMax(0.0);

  const Eigen::VectorXd residual = b - x * fit.coordinates;
  if (rule == OutlierRule::Huber) fit.weights = residual.unaryExpr(&huberWeight);
  fit.outlier_share = static_cast<double>((fit.weights.array() < 0.5).count()) / e.rows();
  if (!uncertainty) return fit;
  const Eigen::VectorXd root = fit.weights.cwiseSqrt();
  fit.block_s = bootstrapBlock_s(e, residual);
  fit.covariance =
      blockBootstrap(e, root.asDiagonal() * x, root.cwiseProduct(b), bounded, fit.block_s, 300, 1, ridge).covariance();
  return fit;
}

}  // namespace knee_robot::identification
