#pragma once

#include <array>
#include <cstdint>

#include "knee_robot/hardware/channels.h"
#include "knee_robot/rt/cycle.h"

namespace knee_robot::control {

/// How long the drives carry after a guardian's trip. The holding brakes have their time to engage; then the drives' force
/// goes down while the encoders are watched, as in a SafeStop. Where an axis moves meanwhile its brake does not hold
/// yet: the drives give the whole load again and the hand-over is tried once more, until nothing moves, an axis has gone
/// too far, or it has lasted too long. Nobody closes a loop here: what the drives give is what
/// carried the robot at rest. Pure, real-time safe.
class GuardianHandOver {
 public:
  using Counts = std::array<std::int32_t, hardware::kChannels>;

  static constexpr rt::Nanoseconds kTransfer = 80'000'000;    ///< from the whole load to none
  static constexpr rt::Nanoseconds kWatch = 300'000'000;      ///< without force, drives on: an axis may begin to creep
  static constexpr rt::Nanoseconds kAgain = 50'000'000;       ///< with the whole load before it is tried again
  static constexpr rt::Nanoseconds kLongest = 2'000'000'000;  ///< in all; a brake that is late engages within a second
  static constexpr std::int32_t kFarthest = 200;  ///< slips: 100 mm; some go on by half of that when they were moving

  /// Begins at `now`. `hold`: what the slowest brake takes. `slip`: counts that mean that a brake does not hold; 0 in one of
  /// them: nothing is watched, and the drives carry for `hold` only.
  void begin(rt::Nanoseconds now, rt::Nanoseconds hold, const Counts& slip) noexcept;
  /// One cycle; `counts`: null where they cannot be read.
  void step(rt::Nanoseconds now, const Counts* counts) noexcept;
  bool isRunning() const noexcept { return phase_ != Phase::Over; }
  /// Beyond the brakes' time: what was given back now would be taken from a hand-over.
  bool isWatching() const noexcept { return isRunning() && watched_; }
  /// Of the load, that the drives give in this cycle.
  double share() const noexcept { return share_; }
  /// First axis (1 to 4) whose brake did not hold when it should have; 0: all did.
  int slipped() const noexcept { return slipped_; }

 private:
  enum class Phase { Over, Engaging, Transferring, Carrying };
  void enter(Phase phase, rt::Nanoseconds now) noexcept;
  int moved(const Counts& from, const Counts& to, std::int32_t slips) const noexcept;

  Phase phase_ = Phase::Over;
  rt::Nanoseconds began_ = 0, entered_ = 0, hold_ = 0;
  Counts slip_{}, from_{}, held_{};
  bool watched_ = false;
  double share_ = 0.0;
  int slipped_ = 0;
};

}  // namespace knee_robot::control
