#include "knee_robot/identification/physical_problem.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

#include "knee_robot/dynamics/pseudo_inertia.h"

namespace knee_robot::identification {
namespace {

constexpr double kInside = 1e-6;

/// Lower triangular root of a pseudo-inertia that may lie on the boundary.
mechanism::Matrix4 rootOf(mechanism::Matrix4 j) {
  const double mass = j(3, 3);
  const double size = j.topLeftCorner<3, 3>().trace();
  j.diagonal().head<3>().array() += kInside * size;
  j(3, 3) += kInside * mass;
  return j.llt().matrixL();
}

/// E of one unit coordinate.
mechanism::Matrix4 unitChange(int coordinate) {
  mechanism::Matrix4 e = mechanism::Matrix4::Zero();
  if (coordinate < 4) {
    e(coordinate, coordinate) = 1.0;
    return e;
  }
  int k = 4;
  for (int row = 0; row < 4; ++row) {
    for (int column = row + 1; column < 4; ++column, ++k) {
      if (k == coordinate) e(row, column) = e(column, row) = M_SQRT1_2;
    }
  }
  return e;
}

}  // namespace

PhysicalCoordinates physicalCoordinates(const dynamics::RobotInertia& prior) {
  return physicalCoordinates(Eigen::VectorXd(dynamics::toParameters(prior)));
}

PhysicalCoordinates physicalCoordinates(const Eigen::VectorXd& prior) {
  PhysicalCoordinates c;
  c.prior = prior;
  const int links = static_cast<int>(prior.size()) / dynamics::kLinkParameters;
  c.transform = Eigen::MatrixXd::Zero(prior.size(), links * PhysicalCoordinates::kPerLink);
  for (int link = 0; link < links; ++link) {
    const mechanism::Matrix4 root =
        rootOf(dynamics::pseudoInertia(c.prior.segment<dynamics::kLinkParameters>(link * dynamics::kLinkParameters)));
    for (int k = 0; k < PhysicalCoordinates::kPerLink; ++k) {
      c.transform.block<dynamics::kLinkParameters, 1>(link * dynamics::kLinkParameters,
                                                      link * PhysicalCoordinates::kPerLink + k) =
          dynamics::parametersOfPseudoInertia(root * unitChange(k) * root.transpose());
    }
  }
  return c;
}

PhysicalProblem physicalProblem(const Eigen::MatrixXd& triangle, const std::vector<Column>& columns,
                                const PhysicalCoordinates& coordinates, const Eigen::VectorXd& offset_size_N) {
  PhysicalProblem p;
  p.target = triangle.col(triangle.cols() - 1);
  const Eigen::Index inertial = coordinates.transform.rows();
  for (int c = static_cast<int>(inertial); c < static_cast<int>(columns.size()); ++c)
    p.free.push_back(c);
  const Eigen::Index count = static_cast<Eigen::Index>(p.free.size());
  p.data.resize(triangle.rows(), coordinates.transform.cols() + count);
  p.data.leftCols(coordinates.transform.cols()) = triangle.leftCols(inertial) * coordinates.transform;
  p.free_size = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Column& column = columns[static_cast<std::size_t>(p.free[static_cast<std::size_t>(i)])];
    p.data.col(coordinates.transform.cols() + i) = triangle.col(p.free[static_cast<std::size_t>(i)]);
    p.nonnegative.push_back(column.isNonNegative());
    if (column.role == ColumnRole::Offset) p.free_size[i] = offset_size_N[column.actuator];
  }
  return p;
}

PriorPull priorPull(const PhysicalProblem& p, double strength) {
  const Eigen::Index inertial = p.data.cols() - p.free_size.size();
  std::vector<Eigen::Index> prior, without;  // columns with and without a prior
  Eigen::VectorXd size = Eigen::VectorXd::Ones(p.data.cols());
  for (Eigen::Index c = 0; c < p.data.cols(); ++c) {
    if (c >= inertial) size[c] = p.free_size[c - inertial];
    (size[c] > 0.0 ? prior : without).push_back(c);
  }
  const Eigen::MatrixXd own = p.data(Eigen::all, without);
  Eigen::MatrixXd seen = p.data(Eigen::all, prior) * size(prior).asDiagonal();
  if (own.cols() > 0) seen -= own * own.completeOrthogonalDecomposition().solve(seen);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(seen, Eigen::ComputeFullV);

  const Eigen::Index n = static_cast<Eigen::Index>(prior.size());
  PriorPull pull;
  Eigen::MatrixXd rows(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double s = k < svd.singularValues().size() ? svd.singularValues()[k] : 0.0;
    const double fade = strength / (strength + s * s);
    const double weight = strength * fade * fade;
    rows.row(k) = std::sqrt(weight) * svd.matrixV().col(k).transpose();
    pull.silent += weight / (weight + s * s);
  }
  pull.root = Eigen::MatrixXd::Zero(n, p.data.cols());
  pull.mean = Eigen::VectorXd::Zero(p.data.cols());
  for (Eigen::Index i = 0; i < n; ++i)
    pull.root.col(prior[static_cast<std::size_t>(i)]) = rows.col(i) / size[prior[static_cast<std::size_t>(i)]];
  for (Eigen::Index c = 0; c < inertial; ++c)
    pull.mean[c] = c % PhysicalCoordinates::kPerLink < 4 ? 1.0 : 0.0;  // E = 1
  return pull;
}

Eigen::VectorXd physicalParameters(const PhysicalSolution& s, const PhysicalProblem& p, const PhysicalCoordinates& c,
                                   const std::vector<Column>& columns) {
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(columns.size()));
  parameters.head(c.transform.rows()) = c.transform * s.inertial;
  for (std::size_t i = 0; i < p.free.size(); ++i)
    parameters[p.free[i]] = s.free[static_cast<Eigen::Index>(i)];
  return parameters;
}

}  // namespace knee_robot::identification
