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

}  // namespace

Eigen::VectorXd changeByJoint(const EffectInput& in, int i, const DriveJoint& joint) {
  const auto motor = in.friction_position_m.col(i);
  const auto rate = in.signals().velocity_m_per_s.col(i);
  const auto acceleration = in.signals().acceleration_m_per_s2.col(i);
  const double period = in.signals().period_s;
  const double dry = in.coulomb_N[i], viscous = in.viscous[i];
  Eigen::VectorXd wound(in.samples()), force(in.samples());
  double screw = motor[0] - windingAt(joint, in.load_N(0, i));
  for (int n = 0; n < in.samples(); ++n) {
    const double load = in.load_N(n, i) - in.rotor_kg[i] * acceleration[n];
    const double over = jointForce(joint, motor[n] - screw) - load;
    if (std::abs(over) > dry) {  // slides until friction balances the joint again
      const double rest = load + std::copysign(dry, over);
      const double free = motor[n] - windingAt(joint, rest);
      const double drag = viscous * (free - screw) / period;
      screw = motor[n] - windingAt(joint, rest + std::clamp(drag, -std::abs(over), std::abs(over)));
    }
    wound[n] = motor[n] - screw;
    force[n] = jointForce(joint, wound[n]) - load;  // friction, as the joint shows it
  }
  recording::ZeroPhaseLowPass(in.signals().motion_cutoff_hz, 1.0 / period).apply(wound);
  const Eigen::VectorXd missing = in.moved_kg[i] * recording::secondDerivative(wound, period);
  const Eigen::VectorXd model = dry * in.share.col(i) + viscous * rate;
  return force - missing - model;
}

}  // namespace knee_robot::tracing
