#pragma once

#include "knee_robot/control/axis_data.h"

namespace knee_robot::control {

/// How one axis is homed; of the hardware file.
struct HomingAxis {
  double length_m = 0.0;  ///< of the leg where the switch closes or the stop is touched
  int direction = -1;     ///< -1: shortens on the way there, +1: lengthens
  double speed_m_per_s = 0.003;
  double force_N = 60.0;     ///< largest force on the way, beyond what the axis carried at rest; more than its friction
  double back_off_m = 0.01;  ///< back into the range afterwards
  double travel_m = 0.35;    ///< farther: homing_failed
};

/// One axis' reference and force limit while it looks for its switch or for the end of its stroke:
///
///     Searching   the reference runs at constant speed, never more than kLead ahead of the axis
///     BackingOff  home was found; the reference goes back by back_off_m, with the full force again; then it searches
///                 once more
///     Found       the axis has come back; it holds there
///     Failed      travel_m or twice its time is over, or the axis does not come back
///
/// A hard stop is where the axis stands for kContact although the reference is kLead ahead: the force is then what
/// kLead and the force limit let through. Stop and switch are searched for twice: friction that is stronger than this
/// force stands like a stop, and a line that is shorted or disturbed reads like a closed switch, but not at the same
/// place again after backing off. Pure, real-time safe.
class HomingMove {
 public:
  static constexpr double kLead_m = 0.0015;
  static constexpr double kContact_s = 0.1;
  static constexpr double kComesBack_s = 0.3;       ///< after the reference, which it follows within some hundredths
  static constexpr double kLeastBackOff_m = 0.002;  ///< farther than axes give way
  static constexpr double kSame_m = 0.5 * kLeastBackOff_m;  ///< between two contacts with one stop or switch

  /// What the Driver does in this cycle instead of following Sync.
  struct Output {
    double reference_m = 0.0;
    double velocity = 0.0;  ///< m/s
    double force_limit_N = 0.0;
  };

  void begin(const HomingAxis& axis, bool on_switch, double position_m) noexcept;
  /// One cycle; `full_force_N` is the axis' own clamp.
  Output step(double measured_m, double velocity, bool switch_on, double dt, double full_force_N) noexcept;
  /// Holds where the reference is; what was not Found has Failed.
  void abandon() noexcept;
  HomingPhase phase() const noexcept { return phase_; }
  /// Where home was found, as measured then, before any shift.
  double found_m() const noexcept { return found_m_; }

 private:
  void search(double measured_m, double velocity, bool switch_on, double dt) noexcept;
  void fail(double measured_m) noexcept;
  void backOff(double measured_m, bool switch_on, double dt) noexcept;

  HomingAxis axis_;
  bool on_switch_ = false;
  HomingPhase phase_ = HomingPhase::Idle;
  double start_m_ = 0.0, reference_m_ = 0.0, velocity_ = 0.0, found_m_ = 0.0;
  double time_s_ = 0.0, standing_s_ = 0.0, waited_s_ = 0.0;
  bool again_ = false;  // it was found and the axis has come back once
};

}  // namespace knee_robot::control
