#include "driven_load.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/recording/filter.h"

namespace knee_robot::tracing {
namespace {

double jointForce(const DriveJoint& joint, double wound) {
  return joint.stiffness_N_per_m * (wound - std::clamp(wound, -joint.half_gap_m, joint.half_gap_m));
}

/// How far the joint is wound when it passes on this force.
double windingAt(const DriveJoint& joint, double force) {
  const double gap = force > 0.0 ? joint.half_gap_m : force < 0.0 ? -joint.half_gap_m : 0.0;
  return gap + force / joint.stiffness_N_per_m;
}

constexpr double kExact_N = 0.005, kExact_m = 1e-10;
constexpr int kMostSteps = 60;         ///< every third halves, which finds kExact_m from more than 0.1 mm
constexpr double kMostFriction = 3.0;  ///< of full dry friction: a bristle's damping exceeds it

/// The screw behind the joint, with its part of the friction.
class Screw {
 public:
  Screw(const DriveJoint& joint, const dynamics::FrictionLaw& law, double dry_N, double viscous_N_s_per_m)
      : joint_(joint), law_(law), dry_N_(dry_N), viscous_(viscous_N_s_per_m) {}

  void start(double motor_m, double load_N, double share) {
    at_m_ = motor_m - windingAt(joint_, load_N);
    friction_.start(std::clamp(share, -1.0, 1.0));
  }

  /// Moves to where the joint's force balances load and friction, by regula falsi between two places beyond it. How far
  /// the joint is wound then.
  double follow(double motor_m, double load_N, double period_s) {
    const auto unbalanced = [&](double way_m) {  // falls with the way
      dynamics::FrictionState then = friction_;
      return jointForce(joint_, motor_m - at_m_ - way_m) - load_N - dry_N_ * then.step(law_, way_m, period_s) -
             viscous_ * way_m / period_s;
    };
    const double drag_N = viscous_ * (std::abs(motor_m - at_m_) + joint_.half_gap_m) / period_s;
    const double most_N = std::abs(load_N) + kMostFriction * dry_N_ + drag_N + kExact_N;
    double low = motor_m - at_m_ - windingAt(joint_, most_N), high = motor_m - at_m_ + windingAt(joint_, most_N);
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

 private:
  const DriveJoint& joint_;
  const dynamics::FrictionLaw& law_;
  const double dry_N_, viscous_;
  dynamics::FrictionState friction_;
  double at_m_ = 0.0;
};

constexpr double kPartBeyond = 0.6, kLeastBeyond = 0.2, kShareBeside = 0.2;
constexpr double kJointBeside = 1.4;  ///< factor between neighbours

}  // namespace

ShapeParameter frictionBeyondParameter() {
  return {"friction_beyond", kLeastBeyond, 1.0, false, 1.0};
}

std::vector<std::vector<double>> withFrictionBeyond(const std::vector<std::vector<double>>& grid) {
  return withLast(grid, {1.0, kPartBeyond});
}

std::vector<std::vector<double>> besideJoint(const std::vector<double>& shape, double step,
                                             const std::vector<ShapeParameter>& limits) {
  std::vector<std::vector<double>> out;
  for (const double sign : {-1.0, 1.0}) {
    const double joint = std::clamp(shape[0] * std::pow(kJointBeside, sign * step), limits[0].low, limits[0].high);
    out.push_back({joint, shape[1]});
    out.push_back({shape[0], std::clamp(shape[1] + sign * step * kShareBeside, limits[1].low, limits[1].high)});
  }
  return out;
}

Eigen::VectorXd changeByJoint(const EffectInput& in, int i, const DriveJoint& joint) {
  const auto motor = in.friction_position_m.col(i);
  const auto rate = in.signals().velocity_m_per_s.col(i);
  const auto acceleration = in.signals().acceleration_m_per_s2.col(i);
  const double period = in.signals().period_s;
  const double dry = joint.friction_beyond * in.coulomb_N[i], viscous = joint.friction_beyond * in.viscous[i];
  Screw screw(joint, in.laws[static_cast<std::size_t>(i)], dry, viscous);
  screw.start(motor[0], in.load_N(0, i), in.share(0, i));
  Eigen::VectorXd wound(in.samples()), friction(in.samples());
  for (int n = 0; n < in.samples(); ++n) {
    const double load = in.load_N(n, i) - in.rotor_kg[i] * acceleration[n];
    wound[n] = screw.follow(motor[n], load, period);
    friction[n] = jointForce(joint, wound[n]) - load;  // as the joint shows it
  }
  recording::ZeroPhaseLowPass(in.signals().motion_cutoff_hz, 1.0 / period).apply(wound);
  const Eigen::VectorXd missing = in.moved_kg[i] * recording::secondDerivative(wound, period);
  const Eigen::VectorXd model = dry * in.share.col(i) + viscous * rate;
  return friction - missing - model;
}

}  // namespace knee_robot::tracing
