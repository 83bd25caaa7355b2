#include "reference_store.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace knee_robot::control {
namespace {

struct Interval {
  std::size_t index;
  double share;
};

/// Interval and share of it at `path_time`; the path has at least two points.
Interval intervalAt(const ReferencePath& path, double path_time) noexcept {
  const double intervals =
      std::clamp(path_time / ReferencePath::kPointPeriod_s, 0.0, static_cast<double>(path.points.size() - 1));
  const std::size_t index = std::min(static_cast<std::size_t>(intervals), path.points.size() - 2);
  return {index, intervals - static_cast<double>(index)};
}

AxisValues between(const AxisValues& a, const AxisValues& b, double share) noexcept {
  AxisValues value{};
  for (std::size_t i = 0; i < value.size(); ++i)
    value[i] = a[i] + share * (b[i] - a[i]);
  return value;
}

}  // namespace

ReferencePath ReferencePath::of(std::vector<AxisValues> points) {
  ReferencePath path;
  path.points = std::move(points);
  path.velocities.assign(path.points.size(), AxisValues{});
  for (std::size_t k = 1; k < path.points.size(); ++k) {
    for (std::size_t i = 0; i < hardware::kAxes; ++i) {
      path.fastest[i] = std::max(path.fastest[i], std::abs(path.points[k][i] - path.points[k - 1][i]) / kPointPeriod_s);
      if (k + 1 < path.points.size()) {
        path.velocities[k][i] = (path.points[k + 1][i] - path.points[k - 1][i]) / (2.0 * kPointPeriod_s);
      }
    }
  }
  return path;
}

AxisValues ReferencePath::positionAt(double path_time) const noexcept {
  if (points.size() < 2) return points.front();
  const Interval interval = intervalAt(*this, path_time);
  return between(points[interval.index], points[interval.index + 1], interval.share);
}

AxisValues ReferencePath::velocityAt(double path_time) const noexcept {
  if (points.size() < 2) return {};
  const Interval interval = intervalAt(*this, path_time);
  return between(velocities[interval.index], velocities[interval.index + 1], interval.share);
}

void ReferenceStore::offer(ReferencePath path) {
  const std::lock_guard<std::mutex> lock(offering_);
  std::uint32_t word = word_.load(std::memory_order_acquire);
  while ((word & kPending) != 0 && !word_.compare_exchange_weak(word, word & kActive, std::memory_order_acq_rel)) {
  }
  const std::uint32_t active = word & kActive;  // fixed now: Sync moves it only when something is pending
  slots_[1 - active] = std::move(path);
  word_.store(active | kPending, std::memory_order_release);
}

const ReferencePath* ReferenceStore::adopt() noexcept {
  std::uint32_t word = word_.load(std::memory_order_acquire);
  if ((word & kPending) != 0) {
    const std::uint32_t adopted = 1 - (word & kActive);
    if (word_.compare_exchange_strong(word, adopted, std::memory_order_acq_rel)) word = adopted;
  }
  const ReferencePath& path = slots_[word & kActive];
  return path.empty() ? nullptr : &path;
}

}  // namespace knee_robot::control
