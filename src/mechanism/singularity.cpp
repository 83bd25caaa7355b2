#include "knee_robot/mechanism/singularity.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "knee_robot/mechanism/constraints.h"

namespace knee_robot::mechanism {
namespace {

/// Largest and smallest singular value.
template <typename Matrix>
std::pair<double, double> extremes(const Matrix& matrix) {
  const Eigen::JacobiSVD<Matrix> svd(matrix);
  if (svd.info() != Eigen::Success) return {1.0, 0.0};  // not finite: as bad as singular
  return {svd.singularValues().maxCoeff(), svd.singularValues().minCoeff()};
}

double conditionOf(const std::pair<double, double>& values) {
  const bool singular = !(values.second > 8.0 * std::numeric_limits<double>::epsilon() * values.first);
  return singular ? std::numeric_limits<double>::infinity() : values.first / values.second;
}

}  // namespace

double characteristicLength(const Mechanism& mechanism) {
  double sum = 0.0;
  for (int i = 0; i < 3; ++i)
    sum += mechanism.platform_points[i].norm();
  return sum / 3.0;
}

Singularity singularityAt(const Mechanism& mechanism, const Pose& pose) {
  Singularity result;
  const JointCoordinates q = inverseKinematics(mechanism, pose);
  result.type_one = std::cos(q.q2[0]) * std::cos(q.q2[1]) * std::cos(q.q2[2]);

  const Matrix4 jacobian = lengthJacobian(mechanism, pose);
  result.determinant = jacobian.determinant();
  result.condition = conditionNumber(mechanism, pose);

  Matrix4 scaled = jacobian;
  scaled.rightCols<2>() /= characteristicLength(mechanism);
  const std::pair<double, double> transmission = extremes(scaled);
  result.scaled_condition = conditionOf(transmission);
  result.force_amplification = 1.0 / transmission.second;

  Motion still;
  still.pose = pose;
  const ConstraintJacobian a = constraintJacobian(mechanism, coordinateMotion(mechanism, still).position);
  Eigen::Matrix<double, kConstraints, kConstraints> dependent;
  for (int k = 0; k < kConstraints; ++k)
    dependent.col(k) = a.col(kDependent[k]);
  result.dependent_condition = conditionOf(extremes(dependent));
  return result;
}

double foldDistance(const Mechanism& mechanism, const Pose& pose) {
  constexpr double kStep_m = 1e-4;
  const double length = characteristicLength(mechanism);
  const auto scaled = [&](const Pose& at) {
    Matrix4 j = lengthJacobian(mechanism, at);
    j.rightCols<2>() /= length;
    return j;
  };
  const Eigen::JacobiSVD<Matrix4> svd(scaled(pose), Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (svd.info() != Eigen::Success) return 0.0;
  const Vector4 u = svd.matrixU().col(3);
  const Vector4 v = svd.matrixV().col(3);
  Pose step = kStep_m * v;
  step.tail<2>() /= length;
  const double slope = u.dot((scaled(pose + step) - scaled(pose - step)) * v) / (2.0 * kStep_m);
  const double smallest = svd.singularValues()[3];
  return smallest * smallest / std::max(2.0 * std::abs(slope), std::numeric_limits<double>::min());
}

}  // namespace knee_robot::mechanism
