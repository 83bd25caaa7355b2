#include "screw_behind_joint.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::tracing {
namespace {

constexpr double kExact_N = 0.005, kExact_m = 1e-10;
constexpr int kMostSteps = 60;         ///< every third halves, which finds kExact_m from more than 0.1 mm
constexpr double kMostFriction = 3.0;  ///< of full dry friction: a bristle's damping exceeds it

}  // namespace

double DriveJoint::force_N(double wound_m) const {
  return stiffness_N_per_m * (wound_m - std::clamp(wound_m, -half_gap_m, half_gap_m));
}

double DriveJoint::windingAt(double force_N) const {
  const double gap = force_N > 0.0 ? half_gap_m : force_N < 0.0 ? -half_gap_m : 0.0;
  return gap + force_N / stiffness_N_per_m;
}

void ScrewBehindJoint::start(double motor_m, double wound_m, double share) {
  at_m_ = motor_m - wound_m;
  friction_.start(std::clamp(share, -1.0, 1.0));
}

double ScrewBehindJoint::follow(double motor_m, const YieldingLoad& load, double period_s) {
  const auto unbalanced = [&](double way_m) {  // falls with the way
    dynamics::FrictionState then = friction_;
    const double wound = motor_m - at_m_ - way_m;
    return joint_.force_N(wound) + load.falls_N_per_m * wound - load.at_zero_N -
           dry_N_ * then.step(law_, way_m, period_s) - viscous_ * way_m / period_s;
  };
  const double drag_N = viscous_ * (std::abs(motor_m - at_m_) + joint_.half_gap_m) / period_s;
  const double most_N = std::abs(load.at_zero_N) + kMostFriction * dry_N_ + drag_N + kExact_N;
  double low = motor_m - at_m_ - joint_.windingAt(most_N), high = motor_m - at_m_ + joint_.windingAt(most_N);
  double over_low = unbalanced(low), over_high = unbalanced(high), way = 0.5 * (low + high);
  for (int k = 0; k < kMostSteps; ++k) {
    // Halved now and then: where dry friction turns round the straight line leads nowhere.
    way = k % 3 == 2 ? 0.5 * (low + high) : (low * over_high - high * over_low) / (over_high - over_low);
    const double over = unbalanced(way);
    if (std::abs(over) < kExact_N || high - low < kExact_m) break;
    (over > 0.0 ? low : high) = way;
    (over > 0.0 ? over_low : over_high) = over;
  }
  friction_.step(law_, way, period_s);
  at_m_ += way;
  return motor_m - at_m_;
}

}  // namespace knee_robot::tracing
