#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace knee_robot::control {

/// Asks a standing encoder whether it counts. While a load may already be taking a blind axis along, at once and for
/// good:
///
///     +S for T, -U for T, +U for T, then kListen_s      S has been enough before, U certainly is (from EncoderProbe)
///
/// Where the reference moves +U comes before -U. If there is time (`gentle`), the force first ramps up to S within
/// kRise_s. It ends as soon as the encoder has answered, so a healthy axis goes some steps only, towards its reference;
/// when it was there, a wave without mean brings it back (-S for 2 t, +S for t when it answered at t). Not a single
/// count to the end: dead, or blocked. A count, but no answer: -U and +U alternate on, kLongest times in all, because
/// the other axes' pulses can stop one, as long as the reference has not left the axis behind: who is blind and dithers
/// as an open input does runs away meanwhile. One a Driver; real-time safe.
class EncoderChallenge {
 public:
  static constexpr double kWave_s = 0.008;  // T
  static constexpr double kListen_s = 0.004;
  static constexpr double kRise_s = 0.040;
  static constexpr int kAnswer = 2;               // counts beyond what it dithered by
  static constexpr int kShort = 3, kLongest = 9;  // waves

  enum class Verdict { None, Alive, Dead };
  /// How strongly to ask, and where the axis should be.
  struct Question {
    double enough_N;   // S
    double certain_N;  // U
    double away;       // counts from where the axis is to its reference
    std::int64_t dithers = 0;
    bool gentle = false;
    bool moving =
        false;  // U begins towards the reference: an axis that sticks where it turns has to be pushed on, not back
  };

  void reset() noexcept { phase_ = Phase::Idle; }
  /// A pulse is under way.
  bool isActive() const noexcept { return phase_ != Phase::Idle; }

  void begin(std::int64_t counts, const Question& question) noexcept {
    phase_ = Phase::Asking;
    question_ = question;
    sign_ = question.away < 0.0 ? -1.0 : 1.0;
    time_s_ = question.gentle ? -kRise_s : 0.0;
    lowest_ = highest_ = counts;
  }

  /// Every cycle. Alive or Dead once; after Alive a pulse that goes back may follow. `patient`: a count without an
  /// answer is reason to go on asking.
  Verdict step(double dt, std::int64_t counts, bool patient = true) noexcept {
    const double step = std::min(dt, kWave_s);  // a pause of the machine does not eat the question
    force_N_ = 0.0;
    switch (phase_) {
      case Phase::Idle:
        return Verdict::None;
      case Phase::Asking:
        return ask(step, counts, patient);
      case Phase::Returning:
        goBack(step);
        return Verdict::None;
    }
    return Verdict::None;
  }
  /// To be added to the axis' force in this cycle.
  double force_N() const noexcept { return sign_ * force_N_; }

 private:
  enum class Phase { Idle, Asking, Returning };

  Verdict ask(double step, std::int64_t counts, bool patient) noexcept {
    lowest_ = std::min(lowest_, counts);
    highest_ = std::max(highest_, counts);
    const std::int64_t counted = highest_ - lowest_ - question_.dithers;
    if (counted >= kAnswer) {
      const bool was_there = std::abs(question_.away) <= kAnswer;
      phase_ = was_there && time_s_ > 0.0 && time_s_ <= kWave_s ? Phase::Returning : Phase::Idle;
      answered_s_ = time_s_;
      time_s_ = 0.0;
      goBack(0.0);
      return Verdict::Alive;
    }
    const double waves_s = kWave_s * (counted > 0 && patient ? kLongest : kShort);
    if (time_s_ >= waves_s + kListen_s) {
      phase_ = Phase::Idle;
      return Verdict::Dead;
    }
    const double enough_N = std::min(question_.enough_N, question_.certain_N);
    if (time_s_ < 0.0)
      force_N_ = enough_N * (1.0 + time_s_ / kRise_s);
    else if (time_s_ < kWave_s)
      force_N_ = enough_N;
    else if (time_s_ < waves_s)
      force_N_ = (static_cast<int>(time_s_ / kWave_s) % 2 == 1) != question_.moving ? -question_.certain_N
                                                                                    : question_.certain_N;
    time_s_ += step;
    return Verdict::None;
  }
  void goBack(double step) noexcept {
    if (phase_ != Phase::Returning) return;
    const double push_N = std::min(question_.enough_N, question_.certain_N);
    time_s_ += step;
    if (time_s_ < 3.0 * answered_s_)
      force_N_ = time_s_ < 2.0 * answered_s_ ? -push_N : push_N;
    else
      phase_ = Phase::Idle;
  }

  Phase phase_ = Phase::Idle;
  Question question_{};
  double sign_ = 1.0, time_s_ = 0.0, answered_s_ = 0.0, force_N_ = 0.0;
  std::int64_t lowest_ = 0, highest_ = 0;
};

}  // namespace knee_robot::control
