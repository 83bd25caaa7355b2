#include "behind_springs.h"

#include <Eigen/LU>
#include <algorithm>

#include "length_response.h"

namespace knee_robot::tracing {
namespace {

using mechanism::Matrix4;
using mechanism::Vector4;

constexpr double kSwingStep_s = 0.005;  // of the integration, where samples are closer

/// Legs' lengths less what their encoders say, by the trapezoidal rule.
class Swing {
 public:
  Swing(const LegSprings& springs, double step_s)
      : spring_(springs.stiffness_N_per_m), ratio_(springs.damping_ratio), step_s_(step_s) {}

  /// Moves to where springs, which pull by `force`, balance the load's first order.
  void to(const LengthResponse::Knot& knot, const Vector4& force) {
    Matrix4 stiffness = knot.stiffness;
    stiffness.diagonal() += spring_;
    if (!moves_) {
      longer_ = stiffness.partialPivLu().solve(force);
      rate_.setZero();
      acceleration_.setZero();
      moves_ = true;
    } else {
      step(knot.mass, stiffness, force);
    }
  }
  void rest() {
    moves_ = false;
    longer_ = rate_ = acceleration_ = Vector4::Zero();
  }
  void write(LengthPath& path, int n) const {
    path.length_m.row(n) = longer_.transpose();
    path.rate.row(n) = rate_.transpose();
    path.acceleration.row(n) = acceleration_.transpose();
  }

 private:
  void step(const Matrix4& mass, const Matrix4& stiffness, const Vector4& force) {
    const double h = step_s_;
    const Vector4 damping = 2.0 * ratio_ * (spring_.array() * mass.diagonal().array().max(0.0)).sqrt();
    const Vector4 rate = rate_ + 0.5 * h * acceleration_, longer = longer_ + h * rate_ + 0.25 * h * h * acceleration_;
    Matrix4 whole = mass + 0.25 * h * h * stiffness;
    whole.diagonal() += 0.5 * h * damping;
    acceleration_ = whole.partialPivLu().solve(force - damping.cwiseProduct(rate) - stiffness * longer);
    rate_ = rate + 0.5 * h * acceleration_;
    longer_ = longer + 0.25 * h * h * acceleration_;
  }

  const Vector4 spring_;
  const double ratio_, step_s_;
  bool moves_ = false;
  Vector4 longer_ = Vector4::Zero(), rate_ = Vector4::Zero(), acceleration_ = Vector4::Zero();
};

/// Rows between n - stride and n in proportion to time.
void fillUp(Eigen::MatrixXd& all, int n, int stride) {
  for (int k = 1; k < stride && n > 0; ++k)
    all.row(n - stride + k) =
        all.row(n - stride) + (all.row(n) - all.row(n - stride)) * static_cast<double>(k) / stride;
}

/// `force_N`: with which the springs pull, less what hangs on them along the encoders' path.
LengthPath swing(const EffectInput& in, const LegSprings& springs, const Eigen::MatrixXd& force_N) {
  const int stride = std::max(1, static_cast<int>(kSwingStep_s / in.signals().period_s));
  Swing platform(springs, stride * in.signals().period_s);
  LengthPath path(in.samples(), in.axes());
  int last = 0;
  for (int n = 0; n < in.samples(); n += stride) {
    last = n;
    const LengthResponse::Knot knot = in.by_lengths->at(in, n);
    if (knot.known) {
      platform.to(knot, force_N.row(n).transpose());
    } else {
      platform.rest();
    }
    platform.write(path, n);
    for (Eigen::MatrixXd* all : {&path.length_m, &path.rate, &path.acceleration})
      fillUp(*all, n, stride);
  }
  for (int n = last + 1; n < in.samples(); ++n)  // less than a step is left
    platform.write(path, n);
  return path;
}

Eigen::MatrixXd firstOrder(const EffectInput& in, const LengthPath& path) {
  Eigen::MatrixXd change = Eigen::MatrixXd::Zero(in.samples(), mechanism::kLegs);
  for (int n = 0; n < in.samples(); ++n) {
    const LengthResponse::Knot knot = in.by_lengths->at(in, n);
    if (!knot.known) continue;
    change.row(n) =
        (knot.stiffness * path.length_m.row(n).transpose() + knot.mass * path.acceleration.row(n).transpose())
            .transpose();
  }
  return change;
}

}  // namespace

Eigen::MatrixXd changeBehindSprings(const EffectInput& in, const LegSprings& springs, const Eigen::MatrixXd& longer_m) {
  const Eigen::MatrixXd force = longer_m * springs.stiffness_N_per_m.asDiagonal();
  LengthPath path = swing(in, springs, force);
  if (path.length_m.cwiseAbs().maxCoeff() < kFirstOrder_m) return forceOrNone(firstOrder(in, path));
  Eigen::MatrixXd beyond = in.by_lengths->beyondFirstOrder(in, path);
  path = swing(in, springs, force - beyond);
  beyond = in.by_lengths->beyondFirstOrder(in, path);
  return forceOrNone(firstOrder(in, path) + beyond);
}

}  // namespace knee_robot::tracing
