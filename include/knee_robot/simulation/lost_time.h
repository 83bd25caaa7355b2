#pragma once

#include <cstdint>

namespace knee_robot::simulation {

/// Whole periods that a simulated robot leaves out when it is `late_ns` behind the clock; 0 for up to ten periods,
/// which it catches up.
/// A longer pause of the process, caught up in one go, would be a motion that no controller could answer, under the
/// force that it wrote against a robot that stood still.
inline std::int64_t lostPeriods(std::int64_t late_ns, std::int64_t period_ns) noexcept {
  constexpr std::int64_t kLargestCatchUp = 10;
  return late_ns > kLargestCatchUp * period_ns ? late_ns / period_ns : 0;
}

}  // namespace knee_robot::simulation
