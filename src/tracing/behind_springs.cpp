#include "behind_springs.h"

#include <Eigen/LU>
#include <algorithm>

#include "length_response.h"

namespace knee_robot::tracing {
namespace {

using mechanism::Matrix4;
using mechanism::Vector4;

constexpr double kSwingStep_s = 0.005;  // of the integration, where samples are closer
constexpr double kDampingRatio = 0.05;  // of screws and couplings; slow loads do not show it

/// Legs' lengths less what their encoders say, by the trapezoidal rule.
class Swing {
 public:
  Swing(double spring, double step_s) : spring_(spring), step_s_(step_s) {}

  /// Change of the load by where the platform is then.
  Vector4 to(const LengthResponse::Knot& knot, const Vector4& longer_m) {
    Matrix4 stiffness = knot.stiffness;
    stiffness.diagonal().array() += spring_;
    const Vector4 force = spring_ * longer_m;
    if (!moves_) {
      longer_ = stiffness.partialPivLu().solve(force);
      rate_.setZero();
      acceleration_.setZero();
      moves_ = true;
    } else {
      step(knot.mass, stiffness, force);
    }
    return knot.stiffness * longer_ + knot.mass * acceleration_;
  }
  void rest() { moves_ = false; }

 private:
  void step(const Matrix4& mass, const Matrix4& stiffness, const Vector4& force) {
    const double h = step_s_;
    const Vector4 damping = 2.0 * kDampingRatio * (spring_ * mass.diagonal().array().max(0.0)).sqrt();
    const Vector4 rate = rate_ + 0.5 * h * acceleration_, longer = longer_ + h * rate_ + 0.25 * h * h * acceleration_;
    Matrix4 whole = mass + 0.25 * h * h * stiffness;
    whole.diagonal() += 0.5 * h * damping;
    acceleration_ = whole.partialPivLu().solve(force - damping.cwiseProduct(rate) - stiffness * longer);
    rate_ = rate + 0.5 * h * acceleration_;
    longer_ = longer + 0.25 * h * h * acceleration_;
  }

  const double spring_, step_s_;
  bool moves_ = false;
  Vector4 longer_ = Vector4::Zero(), rate_ = Vector4::Zero(), acceleration_ = Vector4::Zero();
};

}  // namespace

Eigen::MatrixXd changeBehindSprings(const EffectInput& in, double stiffness_N_per_m, const Eigen::MatrixXd& longer_m) {
  const int samples = in.samples();
  const int stride = std::max(1, static_cast<int>(kSwingStep_s / in.signals().period_s));
  Swing swing(stiffness_N_per_m, stride * in.signals().period_s);
  Eigen::MatrixXd change = Eigen::MatrixXd::Zero(samples, mechanism::kLegs);
  int last = 0;
  for (int n = 0; n < samples; n += stride) {
    last = n;
    const LengthResponse::Knot knot = in.by_lengths->at(in, n);
    if (!knot.known) {
      swing.rest();
      continue;
    }
    change.row(n) = swing.to(knot, longer_m.row(n).transpose()).transpose();
    for (int k = 1; k < stride && n > 0; ++k)
      change.row(n - stride + k) =
          change.row(n - stride) + (change.row(n) - change.row(n - stride)) * static_cast<double>(k) / stride;
  }
  for (int n = last + 1; n < samples; ++n)  // less than a step is left
    change.row(n) = change.row(last);
  return change;
}

}  // namespace knee_robot::tracing
