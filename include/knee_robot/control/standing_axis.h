#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace knee_robot::control {

/// How far the loop's force has changed since the encoder counted last. A loop that pushes more and more while the
/// encoder stands pushes an axis that sticks, or one that is blind and about to leave: only asking tells. The same
/// while the reference goes on by more than an encoder could overlook (isOverdue()). Changes within the dither of an
/// open input do not count as motion. What a healthy axis takes before it leaves a turning point is learned
/// (usual_N()), so that it is not asked every time it turns. One a Driver; real-time safe.
class StandingAxis {
 public:
  static constexpr std::int64_t kDither = 4;  // counts
  static constexpr double kWindow_s = 0.025;
  static constexpr int kTurns = 4;             // within that; an open input has many more
  static constexpr double kOverdue = 10.0;     // counts that the reference has gone on by
  static constexpr double kOverdue_m = 5e-5;   // and that
  static constexpr double kOverdue_s = 0.008;  // and so long
  static constexpr double kForgets_s = 120.0;  // the time in which usual_N() falls to a third

  /// `force_N`: of integral and proportional term; the derivative fades by itself when an axis comes to rest. `pulsed`:
  /// what it counts now is what it is made to.
  void step(double dt, std::int64_t counts, double reference_m, double force_N, bool pulsed = false) noexcept {
    reference_m_ = reference_m;
    stood_s_ += dt;
    usual_N_ *= 1.0 - std::min(1.0, dt / kForgets_s);
    time_s_ += dt;
    if (time_s_ >= kWindow_s) {
      time_s_ = 0.0;
      before_ = now_;
      now_ = {counts, counts, 0};
    }
    now_.take(counts);
    since_.take(counts);
    const std::int64_t moved = counts - last_;
    const bool leaves = since_.range() > kDither;
    if (leaves && !pulsed) usual_N_ = std::max(usual_N_, changed_N());
    if (!pulsed && moved != 0 && moved * last_moved_ < 0) ++now_.turns;
    if (moved != 0) last_moved_ = moved;
    last_ = counts;
    force_N_ = force_N;
    if (leaves) direction_ = counts == since_.highest ? 1.0 : -1.0;
    if (leaves) begin(counts);
  }
  /// From here on.
  void begin(std::int64_t counts) noexcept {
    since_ = {counts, counts, 0};
    began_N_ = force_N_;
    began_m_ = reference_m_;
    stood_s_ = 0.0;
  }
  /// The encoder answered a test at this change of force: the axis withstands it without moving.
  void endures(double force_N) noexcept { usual_N_ = std::max(usual_N_, force_N); }
  /// It moves, more than an open input seems to, within the last kWindow_s to twice that: nobody has to ask.
  bool counts() const noexcept {
    const Range& more = now_.range() > before_.range() ? now_ : before_;
    return more.range() > kDither && more.turns < kTurns;
  }
  /// The reference has gone on the way that the axis was moving when it counted last, and a healthy axis would have
  /// followed. `count_m`:
  /// what a count is.
  bool isOverdue(double count_m) const noexcept {
    return stood_s_ >= kOverdue_s && direction_ * (reference_m_ - began_m_) > std::max(kOverdue * count_m, kOverdue_m);
  }
  double changed_N() const noexcept { return std::abs(force_N_ - began_N_); }
  /// The most that changed_N() came to before the axis counted again by itself, forgotten within kForgets_s.
  double usual_N() const noexcept { return usual_N_; }
  /// Counts that it goes up and down by; none where it only moves on, or stands.
  std::int64_t dithers() const noexcept { return std::max(now_.dithers(), before_.dithers()); }

 private:
  struct Range {
    std::int64_t lowest = 0, highest = 0;
    int turns = 0;
    void take(std::int64_t counts) noexcept {
      lowest = std::min(lowest, counts);
      highest = std::max(highest, counts);
    }
    std::int64_t range() const noexcept { return highest - lowest; }
    std::int64_t dithers() const noexcept { return turns >= kTurns ? std::min(kDither, range()) : 0; }
  };
  Range now_, before_, since_;
  std::int64_t last_ = 0, last_moved_ = 0;
  double time_s_ = 0.0, force_N_ = 0.0, began_N_ = 0.0, usual_N_ = 0.0;
  double direction_ = 0.0;  // of the last way that was no dither
  double reference_m_ = 0.0, began_m_ = 0.0, stood_s_ = 0.0;
};

}  // namespace knee_robot::control
