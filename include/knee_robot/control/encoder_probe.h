#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace knee_robot::control {

/// Finds an encoder that has died while its axis stands, at rest or around a turning point. Nothing passive can: a
/// healthy axis sticks and does not count either, and the load takes a blind one along with hardly a trace in the other
/// axes' forces. So, like the test pulses of a safety output, the force of an axis whose encoder stands gets a short
/// pulse without mean,
///
///     +A for T, -A for 2 T, +A for T        (the axis goes there and back by some hundredths of a millimetre)
///
/// and the encoder has to answer with kAnswer counts, more than an open input dithers by. The strength s is learnt: as
/// little as the axis answers to. A = s and T = 6 ms up to A = `largest_N`; above, T grows so that A T^2, which is what
/// moves a heavy axis, grows with s.
/// No answer: again with half as much more, twice, then with four times and 80 N more than what has been enough (before
/// anything has: in steps up to T = 13 ms). If the two strongest pulses also go unanswered, the encoder is dead or the
/// axis blocked.
/// At rest every `period_s`; while the reference moves, as soon as the encoder has stood for kStands_s. `once`: only
/// until it has answered.
/// One a Driver; real-time safe.
class EncoderProbe {
 public:
  static constexpr double kPulse_s = 0.006;   // the shortest T
  static constexpr double kListen_s = 0.010;  // after the pulse
  static constexpr double kAgain_s = 0.010;   // between two tries
  static constexpr double kStands_s = 0.04;
  static constexpr double kMoving_s = 0.15;  // between an answer and the next probe while the reference moves
  static constexpr int kAnswer = 6;          // counts
  static constexpr int kDither = 4;          // counts, of an open input

  /// When to probe and how strongly; the deployment file's.
  struct Settings {
    double first_s;     // rest before the first probe
    double period_s;    // at rest; 0: no probe at all
    double largest_N;   // A
    bool once = false;  // only until the encoder has answered since reset()
  };

  void reset() noexcept {
    pulsing_ = answered_ = false;
    failures_ = 0;
    wait_s_ = 0.0;
    rest_s_ = stood_s_ = 0.0;
    force_N_ = 0.0;
  }

  /// One cycle of `dt` in which the loop alone carries the axis. `rests`: the reference stands. False: the encoder does
  /// not answer.
  bool step(bool rests, double dt, std::int64_t counts, const Settings& settings) noexcept {
    force_N_ = 0.0;
    if (settings.period_s <= 0.0) return true;
    const double step = std::min(dt, kPulse_s);  // a pause of the machine does not eat a pulse
    rest_s_ = rests ? rest_s_ + step : 0.0;
    stood_s_ += step;
    lowest_ = std::min(lowest_, counts);
    highest_ = std::max(highest_, counts);
    if (!pulsing_ && highest_ - lowest_ > kDither) {
      begin(counts);
      failures_ = 0;
    }
    wait_s_ -= step;
    if (!rests) wait_s_ = std::min(wait_s_, kMoving_s);
    if (!pulsing_) {
      if (wait_s_ > 0.0 || !isDue(settings)) return true;
      begin(counts);
      pulsing_ = true;
      pulse_s_ = 0.0;
      amplitude_N_ = std::min(strength_N_, settings.largest_N);
      width_s_ = kPulse_s * std::sqrt(std::max(1.0, strength_N_ / settings.largest_N));
    } else {
      pulse_s_ += step;
    }
    if (pulse_s_ < 4.0 * width_s_ + kListen_s) {
      const bool outside = pulse_s_ < width_s_ || pulse_s_ >= 3.0 * width_s_;
      if (pulse_s_ < 4.0 * width_s_) force_N_ = outside ? amplitude_N_ : -amplitude_N_;
      return true;
    }
    pulsing_ = false;
    return evaluate(settings);
  }
  /// To be added to the axis' force in this cycle.
  double force_N() const noexcept { return force_N_; }
  /// For EncoderChallenge: what has been enough, with something to spare, and what certainly is (N).
  double enoughForce_N() const noexcept { return kStep * std::max(strength_N_, enough_N_); }
  double certainForce_N(const Settings& settings) const noexcept {
    return std::min(settings.largest_N, limit_N(settings));
  }
  /// Somebody else has seen the encoder count: what is being asked is answered.
  void acceptAnswer(std::int64_t counts) noexcept {
    begin(counts);
    pulsing_ = false;
    answered_ = true;
    failures_ = 0;
    force_N_ = 0.0;
  }

 private:
  bool isDue(const Settings& settings) const noexcept {
    if (failures_ > 0) return true;
    if (settings.once && answered_) return false;
    const bool turning = rest_s_ < 0.5 * settings.first_s;
    return turning ? stood_s_ >= kStands_s : rest_s_ >= settings.first_s;
  }
  void begin(std::int64_t counts) noexcept {
    lowest_ = highest_ = counts;
    stood_s_ = 0.0;
  }
  double limit_N(const Settings& settings) const noexcept {
    const double utmost_N = kHeaviest * settings.largest_N;
    return enough_N_ > 0.0 ? std::min(utmost_N, kTimes * enough_N_ + kMore_N) : utmost_N;
  }
  bool evaluate(const Settings& settings) noexcept {
    const std::int64_t answer = highest_ - lowest_;
    if (answer >= kAnswer) {
      enough_N_ = std::max(strength_N_, 0.95 * enough_N_);
      if (answer > 3 * kAnswer) strength_N_ = std::max(kLeast_N, 0.85 * strength_N_);
      failures_ = 0;
      answered_ = true;
      wait_s_ = rest_s_ > 0.0 ? settings.period_s : kMoving_s;
      return true;
    }
    const double most_N = limit_N(settings);
    failures_ += strength_N_ >= most_N ? kAtLargest : 1;
    // Where much less has been enough, two steps are patience enough; a healthy axis must not get the strongest at
    // once.
    const bool sure = enough_N_ > 0.0 && failures_ > 2;
    strength_N_ = sure ? most_N : std::min(most_N, kStep * strength_N_);
    wait_s_ = kAgain_s;
    return failures_ < 2 * kAtLargest;
  }

  static constexpr double kLeast_N = 10.0;
  static constexpr double kStep = 1.5;
  static constexpr double kTimes = 4.0;
  static constexpr double kMore_N = 80.0;
  static constexpr double kHeaviest = 5.0;
  static constexpr int kAtLargest = 1000;
  double strength_N_ = 30.0;
  double enough_N_ = 0.0;                          // that has been answered lately; 0: none yet
  double amplitude_N_ = 0.0, width_s_ = kPulse_s;  // of the present pulse
  double pulse_s_ = 0.0;                           // since the begin of the pulse
  double wait_s_ = 0.0;                            // until the next may begin
  double rest_s_ = 0.0;                            // of the reference
  double stood_s_ = 0.0;                           // of the encoder, within what an open input dithers by
  bool pulsing_ = false;
  bool answered_ = false;  // since reset()
  std::int64_t lowest_ = 0, highest_ = 0;
  int failures_ = 0;  // tries in a row without an answer, those with the largest pulse counted kAtLargest times
  double force_N_ = 0.0;
};

}  // namespace knee_robot::control
