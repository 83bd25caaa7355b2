#pragma once

#include <algorithm>
#include <cmath>

#include "monitor_view.h"

namespace knee_robot::control {

/// An encoder that does not count while its reference moves on, or only dithers as an open input does. Evaluated when
/// the reference has moved by `distance_m` and the force has changed by `force_N`, which must be more than sticking
/// friction takes: broken when the encoder has stayed within a tenth of that all the while (within, not net: behind a
/// turning point a healthy axis may be back where it was when the reference is not). An axis whose friction has grown
/// looks the same: where the Driver can, it asks the encoder first (EncoderChallenge), and only silence for kSilence_s
/// is broken. One axis alone cannot tell a dead encoder from an axis that is blocked: the fault names both. It comes
/// before the following-error limit, because a dead encoder lets its axis run with a growing force.
class EncoderFrozenMonitor {
 public:
  enum class Verdict { Counts, Ask, Dead };
  static constexpr double kSilence_s = 0.1;  ///< longer than a question takes

  Verdict step(const AxisView& axis, double distance_m, double force_N) noexcept {
    if (!known_ || axis.answers != answers_) begin(axis);
    moved_m_ += axis.moved_m;
    lowest_m_ = std::min(lowest_m_, moved_m_);
    highest_m_ = std::max(highest_m_, moved_m_);
    const double wanted = std::abs(axis.reference_m - from_m_);
    if (wanted < distance_m) return Verdict::Counts;
    if (highest_m_ - lowest_m_ >= 0.1 * wanted) {
      begin(axis);
      return Verdict::Counts;
    }
    if (asked_s_ == 0.0 && std::abs(axis.force_N - from_N_) < force_N) return Verdict::Counts;
    asked_s_ += axis.dt;
    return axis.can_be_asked && asked_s_ < kSilence_s ? Verdict::Ask : Verdict::Dead;
  }
  /// The encoder has stood still while its reference went half of `distance_m`: not yet enough for a verdict of its
  /// own.
  bool seesNothing(double reference_m, double distance_m) const noexcept {
    const double wanted = std::abs(reference_m - from_m_);
    return known_ && wanted >= 0.5 * distance_m && highest_m_ - lowest_m_ < 0.1 * wanted;
  }
  void reset() noexcept { known_ = false; }

 private:
  void begin(const AxisView& axis) noexcept {
    known_ = true;
    from_m_ = axis.reference_m;
    from_N_ = axis.force_N;
    answers_ = axis.answers;
    moved_m_ = lowest_m_ = highest_m_ = asked_s_ = 0.0;
  }
  bool known_ = false;
  std::uint32_t answers_ = 0;
  double asked_s_ = 0.0;  // since it was to be asked
  double from_m_ = 0.0, from_N_ = 0.0, moved_m_ = 0.0;
  double lowest_m_ = 0.0, highest_m_ = 0.0;  // of moved_m_
};

}  // namespace knee_robot::control
