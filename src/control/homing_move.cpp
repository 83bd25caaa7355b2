#include "knee_robot/control/homing_move.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::control {

void HomingMove::begin(const HomingAxis& axis, bool on_switch, double position_m) noexcept {
  axis_ = axis;
  on_switch_ = on_switch;
  phase_ = HomingPhase::Searching;
  start_m_ = reference_m_ = found_m_ = position_m;
  velocity_ = 0.0;
  time_s_ = standing_s_ = waited_s_ = 0.0;
  again_ = false;
}

HomingMove::Output HomingMove::step(double measured_m, double velocity, bool switch_on, double dt,
                                    double full_force_N) noexcept {
  if (phase_ == HomingPhase::Searching) search(measured_m, velocity, switch_on, dt);
  if (phase_ == HomingPhase::BackingOff) backOff(measured_m, switch_on, dt);
  const bool gentle = phase_ == HomingPhase::Searching;
  return {reference_m_, velocity_, gentle ? std::min(axis_.force_N, full_force_N) : full_force_N};
}

void HomingMove::search(double measured_m, double velocity, bool switch_on, double dt) noexcept {
  time_s_ += dt;
  velocity_ = axis_.direction * axis_.speed_m_per_s;
  const double wanted = reference_m_ + velocity_ * dt;
  const double farthest = measured_m + axis_.direction * kLead_m;
  const bool ahead = axis_.direction > 0 ? wanted >= farthest : wanted <= farthest;
  reference_m_ = ahead ? farthest : wanted;
  const bool stands = ahead && std::abs(velocity) < 0.2 * axis_.speed_m_per_s;
  standing_s_ = stands ? standing_s_ + dt : 0.0;
  const bool found = on_switch_ ? switch_on : standing_s_ >= kContact_s;
  const bool too_far = !(std::abs(measured_m - start_m_) <= axis_.travel_m);
  const bool too_long = !(time_s_ <= 2.0 * axis_.travel_m / axis_.speed_m_per_s);
  // A switch that is never reached but stopped by the end of the stroke: the axis stands, and nothing is found.
  const bool blocked = on_switch_ && standing_s_ >= 10.0 * kContact_s;
  const double beyond_m = again_ ? axis_.direction * (measured_m - found_m_) : 0.0;
  const bool elsewhere = beyond_m > kSame_m || (found && beyond_m < -kSame_m);
  if (elsewhere || (!found && (too_far || too_long || blocked))) return fail(measured_m);
  if (!found) return;
  found_m_ = measured_m;
  reference_m_ = measured_m;
  waited_s_ = 0.0;
  phase_ = HomingPhase::BackingOff;
}

void HomingMove::fail(double measured_m) noexcept {
  velocity_ = 0.0;
  reference_m_ = measured_m;
  phase_ = HomingPhase::Failed;
}

void HomingMove::abandon() noexcept {
  if (phase_ == HomingPhase::Found) return;
  phase_ = HomingPhase::Failed;
  velocity_ = 0.0;
}

/// An axis that cannot move, or whose encoder does not count, stands as one does at its stop; but it does not come back.
/// A switch that is still closed then says nothing of the place.
void HomingMove::backOff(double measured_m, bool switch_on, double dt) noexcept {
  const double target = found_m_ - axis_.direction * axis_.back_off_m;
  velocity_ = -axis_.direction * axis_.speed_m_per_s;
  reference_m_ += velocity_ * dt;
  const bool there = axis_.direction > 0 ? reference_m_ <= target : reference_m_ >= target;
  if (!there) return;
  reference_m_ = target;
  velocity_ = 0.0;
  waited_s_ += dt;
  const double back_m = axis_.direction * (found_m_ - measured_m);
  const bool came_back = back_m >= 0.5 * axis_.back_off_m && !(on_switch_ && switch_on);
  if (came_back && again_) {
    phase_ = HomingPhase::Found;
  } else if (came_back) {
    again_ = true;
    start_m_ = measured_m;
    time_s_ = standing_s_ = 0.0;
    phase_ = HomingPhase::Searching;
  } else if (!(waited_s_ < kComesBack_s)) {
    phase_ = HomingPhase::Failed;
  }
}

}  // namespace knee_robot::control
