#pragma once

#include <array>
#include <cstdint>

#include "knee_robot/hardware/brake_watch.h"
#include "knee_robot/rt/cycle.h"

namespace knee_robot::control {

/// How long the drives carry after a guardian's trip. The holding brakes have their time to engage; then the drives'
/// force goes down while the encoders are watched, as in a SafeStop. Where an axis moves meanwhile its brake does not
/// hold yet: the drives give the whole load again and the hand-over is tried once more, until nothing moves, an axis has
/// gone too far, or it has lasted too long. Nobody closes a loop here: what the drives give is what carried the robot at
/// rest. An encoder that goes to and fro faster than anything moves is no brake that slips: from then on the mean of its
/// axis counts, as in AxesOutput. Pure, real-time safe.
class GuardianHandOver {
 public:
  using Counts = std::array<std::int32_t, hardware::kChannels>;

  static constexpr rt::Nanoseconds kTransfer = 80'000'000;    ///< from the whole load to none
  static constexpr rt::Nanoseconds kWatch = 300'000'000;      ///< without force, drives on: an axis may begin to creep
  static constexpr rt::Nanoseconds kAgain = 50'000'000;       ///< with the whole load before it is tried again
  static constexpr rt::Nanoseconds kLongest = 2'000'000'000;  ///< in all; a brake that is late engages within a second
  static constexpr double kFarthest_mm = 100.0;               ///< some go on by half of that when they were moving

  /// Begins at `now`. `hold`: what the slowest brake takes. A slip of 0 in `watch`: nothing is watched, and the drives
  /// carry for `hold` only.
  void begin(rt::Nanoseconds now, rt::Nanoseconds hold, const hardware::BrakeWatch& watch) noexcept;
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
  using Places = std::array<double, hardware::kChannels>;  ///< counts from where the axes were at first

  void enter(Phase phase, rt::Nanoseconds now) noexcept;
  void look(rt::Nanoseconds now, const Counts& counts) noexcept;
  int slips() const noexcept;
  bool isTooFar() const noexcept;

  Phase phase_ = Phase::Over;
  rt::Nanoseconds began_ = 0, entered_ = 0, hold_ = 0, looked_ = 0;
  hardware::BrakeWatch watch_;
  Counts last_{};
  Places position_{}, way_{}, mean_{}, place_{}, from_{}, held_{};
  std::array<bool, hardware::kChannels> noisy_{};
  int looks_ = 0;  ///< without a gap, at most 3
  bool watched_ = false;
  double share_ = 0.0;
  int slipped_ = 0;
};

}  // namespace knee_robot::control
