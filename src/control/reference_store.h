#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <vector>

#include "knee_robot/control/axis_data.h"
#include "knee_robot/trajectory/reference_file.h"

namespace knee_robot::control {

/// What Sync plays: points kPointPeriod_s apart, as references are streamed, with what was calculated from them
/// beforehand.
struct ReferencePath {
  static constexpr double kPointPeriod_s = trajectory::kStreamPeriod;

  std::vector<AxisValues> points;      ///< m
  std::vector<AxisValues> velocities;  ///< m/s at the points: central differences, zero at both ends
  AxisValues fastest{};                ///< m/s per axis, of the intervals

  static ReferencePath of(std::vector<AxisValues> points);

  bool empty() const noexcept { return points.empty(); }
  double duration() const noexcept { return empty() ? 0.0 : kPointPeriod_s * static_cast<double>(points.size() - 1); }
  /// Linear between points; held before the first and after the last. Not for an empty path. Real-time safe.
  AxisValues positionAt(double path_time) const noexcept;
  AxisValues velocityAt(double path_time) const noexcept;
};

/// Hands paths from ordinary threads to Sync without locks in Sync: two slots, one being played, one being filled. A
/// word says which is which; it changes by compare-and-exchange (acquire: the other side's slot content; release: the
/// own one). A path that Sync has not taken over yet is taken back and replaced.
class ReferenceStore {
 public:
  /// Ordinary threads. Allocates; the path that is being played is not touched.
  void offer(ReferencePath path);
  /// Sync only, and only while it does not play: takes over an offered path if there is one. Nullptr: never offered.
  const ReferencePath* adopt() noexcept;

 private:
  static constexpr std::uint32_t kActive = 1, kPending = 2;
  std::array<ReferencePath, 2> slots_;
  std::atomic<std::uint32_t> word_{0};
  std::mutex offering_;
};

}  // namespace knee_robot::control
