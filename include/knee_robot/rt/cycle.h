#pragma once

#include <cmath>
#include <cstdint>

namespace knee_robot::rt {

/// Time since the start of the deployment's clock, ns. Monotonic, the same for all activities of one deployment.
using Nanoseconds = std::int64_t;

inline constexpr Nanoseconds kNanosecondsPerSecond = 1'000'000'000;

constexpr double toSeconds(Nanoseconds time) {
  return static_cast<double>(time) * 1e-9;
}
inline Nanoseconds fromSeconds(double seconds) {
  return static_cast<Nanoseconds>(std::llround(seconds * 1e9));
}

/// CLOCK_MONOTONIC, ns.
Nanoseconds monotonicNow() noexcept;

/// What a component learns about the cycle in which it runs. All components of one activity get the same times.
struct Cycle {
  Nanoseconds time = 0;    ///< planned release: a whole multiple of the activity's period; free of jitter
  Nanoseconds wake = 0;    ///< when the activity really woke; equal to `time` under a virtual clock
  Nanoseconds period = 0;  ///< of this component
};

}  // namespace knee_robot::rt
