#pragma once

#include <array>
#include <cstdint>

#include "knee_robot/simulation/injected_faults.h"

namespace knee_robot::simulation {

/// Applies the ordered faults of the simulated robot's encoders and converters. Keeps what a fault needs to know of the
/// moment in which it came. Real-time safe, deterministic.
class FaultInjector {
 public:
  static constexpr std::size_t kChannels = InjectedFaults::kChannelsOfFaults;
  using Values = std::array<double, kChannels>;

  /// `faults` must outlive this.
  explicit FaultInjector(const InjectedFaults& faults) : faults_(faults) {}

  /// Once a step: voltages that the converters give when they were asked for these (V).
  Values volts(const Values& asked) noexcept;
  /// Once a step: what the encoders count when the truth is this (x4 counts, with fraction); `counts_per_m` is signed.
  Values counts(const Values& truth, const Values& counts_per_m) noexcept;

 private:
  double random() noexcept;  ///< uniform in -1 .. 1

  const InjectedFaults& faults_;
  std::array<EncoderFault, kChannels> active_{};
  Values at_onset_{};  ///< count
  Values missed_{};    ///< counts that are still missing after interruptions
  std::uint8_t stuck_ = 0;
  Values stuck_at_{};  ///< V
  std::uint64_t random_ = 0x9E3779B97F4A7C15ull;
};

}  // namespace knee_robot::simulation
