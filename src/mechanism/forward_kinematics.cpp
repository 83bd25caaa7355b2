#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::mechanism {
namespace {

constexpr double kTolerance = 1e-11;         // m; documented at forwardKinematics
constexpr int kMaximumIterations = 50;       // quadratic convergence needs 3 to 6; the rest is for limited steps
constexpr double kLargestTranslation = 0.1;  // m a step
constexpr double kLargestRotation = 0.3;     // rad a step
constexpr double kConditionMaximum = 1e6;

struct Linearisation {
  Vector4 lengths;
  Matrix4 jacobian;
};

/// Lengths and Jacobian together: they share the sines, the arms and the leg vectors.
void linearise(const Mechanism& mechanism, const Pose& pose, Linearisation& out) {
  const double ct = std::cos(pose[2]), st = std::sin(pose[2]), cp = std::cos(pose[3]), sp = std::sin(pose[3]);
  for (int i = 0; i < 3; ++i) {
    // All platform points lie in the platform's plane (z = 0).
    const Vector3& p = mechanism.platform_points[i];
    const Vector3& b = mechanism.base_points[i];
    const double along = cp * p.x() - sp * p.y(), across = sp * p.x() + cp * p.y();
    const double x = pose[0] + ct * along - b.x(), y = across - b.y(), z = pose[1] - st * along;
    const double length = std::sqrt(x * x + y * y + z * z), inverse = 1.0 / length;
    out.lengths[i] = length;
    out.jacobian(i, 0) = x * inverse;
    out.jacobian(i, 1) = z * inverse;
    out.jacobian(i, 2) = -along * (st * x + ct * z) * inverse;
    out.jacobian(i, 3) = (across * (st * z - ct * x) + along * y) * inverse;
  }
  const double x = pose[0] - mechanism.base_points[3].x(), z = pose[1];
  const double length = std::sqrt(x * x + z * z);
  out.lengths[3] = length;
  out.jacobian.row(3) << x / length, z / length, 0.0, 0.0;
}

/// Shortens a Newton step so that it cannot leap over a fold into another assembly branch unseen.
void limitStep(Vector4& step) {
  const double translation = std::max(std::abs(step[0]), std::abs(step[1])) / kLargestTranslation;
  const double rotation = std::max(std::abs(step[2]), std::abs(step[3])) / kLargestRotation;
  const double excess = std::max(translation, rotation);
  if (excess > 1.0) step /= excess;
}

/// Frobenius norms bound the condition number from above, at most 4 times too large for a 4 x 4 matrix.
double conditionBound(const Matrix4& jacobian) {
  return jacobian.norm() * jacobian.inverse().norm();
}

/// Exact condition only when the cheap bound does not settle it.
bool nearSingular(const Matrix4& jacobian, double bound) {
  if (bound < kConditionMaximum) return false;
  const Eigen::JacobiSVD<Matrix4> svd(jacobian);
  return !(svd.singularValues()[0] < kConditionMaximum * svd.singularValues()[3]);
}

}  // namespace

ForwardResult forwardKinematics(const Mechanism& mechanism, const Lengths& lengths, const Pose& guess) {
  ForwardResult result;
  if (!lengths.allFinite() || !guess.allFinite() || lengths.minCoeff() <= 0.0) return result;

  result.pose = guess;
  result.status = ForwardStatus::NotConverged;
  Linearisation at;
  linearise(mechanism, result.pose, at);
  const bool positive = at.jacobian.determinant() > 0.0;
  for (;; ++result.iterations) {
    const Vector4 error = lengths - at.lengths;
    result.residual_m = error.cwiseAbs().maxCoeff();
    if (!(result.residual_m >= kTolerance)) break;
    if (result.iterations == kMaximumIterations) return result;
    Vector4 step = at.jacobian.inverse() * error;
    if (!step.allFinite()) return result;
    limitStep(step);
    result.pose += step;
    linearise(mechanism, result.pose, at);
  }
  if (!std::isfinite(result.residual_m)) return result;
  // A change of the determinant's sign means that the iteration crossed a singularity: another assembly branch.
  const bool same_branch = (at.jacobian.determinant() > 0.0) == positive;
  result.condition_bound = conditionBound(at.jacobian);
  if (nearSingular(at.jacobian, result.condition_bound)) {
    result.status = ForwardStatus::NearSingular;
  } else if (same_branch) {
    result.status = ForwardStatus::Converged;
  }
  return result;
}

namespace {

/// Level, over the base's centre, at the height that leg 4's length allows.
Pose levelHome(const Mechanism& mechanism, double central_length) {
  const double reach = mechanism.geometry.ds, square = central_length * central_length;
  return {0.0, std::sqrt(std::max(square - reach * reach, 0.01 * square)), 0.0, 0.0};
}

/// Changes the lengths from those of `home` in small portions, so that each solution stays on the branch of the one
/// before.
ForwardResult continuation(const Mechanism& mechanism, const Lengths& lengths, const Pose& home) {
  constexpr double kPortion = 0.02;  // m
  constexpr double kMaximumPortions = 100.0;
  const Lengths start = legLengths(mechanism, home);
  const double distance = (lengths - start).cwiseAbs().maxCoeff();
  const int portions = static_cast<int>(std::clamp(std::ceil(distance / kPortion), 1.0, kMaximumPortions));
  ForwardResult result;
  result.pose = home;
  int iterations = 0;
  for (int k = 1; k <= portions; ++k) {
    const Lengths target = k == portions ? lengths : Lengths(start + (lengths - start) * (double(k) / portions));
    result = forwardKinematics(mechanism, target, result.pose);
    iterations += result.iterations;
    if (!result.ok()) break;
  }
  result.iterations = iterations;
  return result;
}

/// Among the poses with these lengths that start values all around find, with the determinant's sign of `home`: the
/// least turned.
ForwardResult nearestToLevel(const Mechanism& mechanism, const Lengths& lengths, const Pose& home) {
  const bool positive = lengthJacobian(mechanism, home).determinant() > 0.0;
  ForwardResult best;
  best.pose = home;
  best.status = ForwardStatus::NotConverged;
  best.residual_m = (lengths - legLengths(mechanism, home)).cwiseAbs().maxCoeff();
  for (double theta = -0.8; theta < 1.0; theta += 0.4) {
    for (double psi = -1.2; psi < 1.4; psi += 0.4) {
      const ForwardResult found = forwardKinematics(mechanism, lengths, Pose(home[0], home[1], theta, psi));
      const bool upright = found.pose[1] > 0.0 && std::max(std::abs(found.pose[2]), std::abs(found.pose[3])) < kPi / 2;
      if (!found.ok() || !upright) continue;
      if ((lengthJacobian(mechanism, found.pose).determinant() > 0.0) != positive) continue;
      if (!best.ok() || found.pose.tail<2>().norm() < best.pose.tail<2>().norm()) best = found;
    }
  }
  return best;
}

}  // namespace

ForwardResult forwardKinematicsFromHome(const Mechanism& mechanism, const Lengths& lengths) {
  ForwardResult result;
  if (!lengths.allFinite() || lengths.minCoeff() <= 0.0) return result;
  const Pose home = levelHome(mechanism, lengths[3]);
  result = continuation(mechanism, lengths, home);
  // The straight path in the lengths may leave the workspace although both of its ends lie in it.
  return result.status == ForwardStatus::NotConverged ? nearestToLevel(mechanism, lengths, home) : result;
}

}  // namespace knee_robot::mechanism
