#include "knee_robot/rt/statistics.h"

#include <algorithm>

namespace knee_robot::rt {
namespace {

int bucketOf(Nanoseconds duration) noexcept {
  int bucket = 0;
  while (duration > 1 && bucket < DurationHistogram::kBuckets - 1) {
    duration >>= 1;
    ++bucket;
  }
  return bucket;
}

}  // namespace

void DurationHistogram::add(Nanoseconds duration) noexcept {
  const Nanoseconds value = std::max<Nanoseconds>(duration, 0);
  constexpr auto kRelaxed = std::memory_order_relaxed;
  count_.store(count_.load(kRelaxed) + 1, kRelaxed);  // one writer: no read-modify-write needed
  sum_.store(sum_.load(kRelaxed) + value, kRelaxed);
  if (value > max_.load(kRelaxed)) max_.store(value, kRelaxed);
  std::atomic<std::uint64_t>& bucket = buckets_[static_cast<std::size_t>(bucketOf(value))];
  bucket.store(bucket.load(kRelaxed) + 1, kRelaxed);
}

DurationHistogram::Snapshot DurationHistogram::snapshot() const {
  Snapshot copy;
  copy.count = count_.load(std::memory_order_relaxed);
  copy.sum = sum_.load(std::memory_order_relaxed);
  copy.max = max_.load(std::memory_order_relaxed);
  for (std::size_t i = 0; i < copy.buckets.size(); ++i)
    copy.buckets[i] = buckets_[i].load(std::memory_order_relaxed);
  return copy;
}

Nanoseconds DurationHistogram::Snapshot::quantile(double fraction) const {
  std::uint64_t below = 0;
  for (int bucket = 0; bucket < kBuckets; ++bucket) {
    below += buckets[static_cast<std::size_t>(bucket)];
    if (static_cast<double>(below) >= fraction * static_cast<double>(count)) {
      return std::min(max, Nanoseconds{1} << (bucket + 1));
    }
  }
  return max;
}

}  // namespace knee_robot::rt
