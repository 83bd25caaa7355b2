#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "knee_robot/rt/cycle.h"

namespace knee_robot::rt {

/// Durations in buckets of powers of two: bucket b counts [2^b, 2^(b+1)) ns (bucket 0 also 0). One writer, any readers;
/// relaxed atomics: each figure is right by itself, figures read together may be one cycle apart.
class DurationHistogram {
 public:
  static constexpr int kBuckets = 40;

  /// The histogram at one instant; times in ns.
  struct Snapshot {
    std::uint64_t count = 0;
    Nanoseconds sum = 0;
    Nanoseconds max = 0;
    std::array<std::uint64_t, kBuckets> buckets{};
    /// Upper edge of the bucket in which the share `fraction` (0 to 1) of all values is reached; never above max.
    Nanoseconds quantile(double fraction) const;
    double mean() const { return count == 0 ? 0.0 : static_cast<double>(sum) / static_cast<double>(count); }
  };

  void add(Nanoseconds duration) noexcept;
  Snapshot snapshot() const;

 private:
  std::atomic<std::uint64_t> count_{0};
  std::atomic<Nanoseconds> sum_{0};
  std::atomic<Nanoseconds> max_{0};
  std::array<std::atomic<std::uint64_t>, kBuckets> buckets_{};
};

/// How an activity has fared since its start.
struct ActivityStatistics {
  std::atomic<std::uint64_t> cycles{0};        ///< executed
  std::atomic<std::uint64_t> missed{0};        ///< skipped because the one before ended or began too late
  std::atomic<std::uint64_t> overruns{0};      ///< occasions on which at least one cycle was skipped
  std::atomic<std::uint64_t> overruns_row{0};  ///< of these, directly one after the other up to now
  DurationHistogram period;                    ///< from one waking to the next
  DurationHistogram lateness;                  ///< waking after the planned release
  DurationHistogram execution;                 ///< from waking to the end of the last component
};

/// How one component has fared since its activity's start. Lateness is its own: the activity's, plus what those before
/// it took.
struct ComponentStatistics {
  std::atomic<std::uint64_t> updates{0};
  DurationHistogram period;     ///< from one update's begin to the next
  DurationHistogram lateness;   ///< update's begin after the planned release
  DurationHistogram execution;  ///< of one update
};

}  // namespace knee_robot::rt
