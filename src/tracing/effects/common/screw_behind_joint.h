#pragma once

#include "knee_robot/dynamics/friction_law.h"

namespace knee_robot::tracing {

/// Joint between motor and screw: elastic, with play. The encoder and the rotor are on the motor's side.
struct DriveJoint {
  double stiffness_N_per_m = 1e7;
  double half_gap_m = 0.0;
  double friction_beyond = 1.0;  ///< share of the actuator's friction on the screw's side; the rest is the motor's

  /// That it passes on.
  double force_N(double wound_m) const;
  /// How far it is wound when it passes on this force.
  double windingAt(double force_N) const;
};

/// What a screw carries, by how far its joint is wound: the further, the shorter the leg.
struct YieldingLoad {
  double at_zero_N = 0.0, falls_N_per_m = 0.0;
};

/// The screw behind the joint, with its part of the friction.
class ScrewBehindJoint {
 public:
  ScrewBehindJoint(const DriveJoint& joint, const dynamics::FrictionLaw& law, double dry_N, double viscous_N_s_per_m)
      : joint_(joint), law_(law), dry_N_(dry_N), viscous_(viscous_N_s_per_m) {}

  /// Behind a motor at `motor_m`; `share` of dry friction is there.
  void start(double motor_m, double wound_m, double share);
  /// Moves to where the joint's force balances load and friction, by regula falsi between two places beyond it. How far
  /// the joint is wound then.
  double follow(double motor_m, const YieldingLoad& load, double period_s);

 private:
  const DriveJoint joint_;
  const dynamics::FrictionLaw& law_;
  const double dry_N_, viscous_;
  dynamics::FrictionState friction_;
  double at_m_ = 0.0;
};

}  // namespace knee_robot::tracing
