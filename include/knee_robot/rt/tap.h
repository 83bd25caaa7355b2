#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "knee_robot/rt/channel.h"
#include "knee_robot/rt/cycle.h"

namespace knee_robot::rt {

/// What an onlooker (plots, logs: one ordinary thread at a time) sees of an output port: every value that is written
/// while the tap is open, in order. The writer never waits: what finds no room is counted and lost for the onlooker
/// alone.
class TapBase {
 public:
  static constexpr std::size_t kValues = 512;  ///< kept between two looks: half a second at 1 kHz

  virtual ~TapBase() = default;
  /// The next value as its type's bytes, valid until the next call, and when it was written (monotonicNow()); null:
  /// none there.
  virtual const void* next(Nanoseconds& written_at) noexcept = 0;
  /// Values that found the tap full, ever.
  std::uint64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }
  /// Begins with nothing from before.
  void open() noexcept {
    Nanoseconds ignored = 0;
    while (next(ignored) != nullptr) {
    }
    open_.store(true, std::memory_order_release);
  }
  void close() noexcept { open_.store(false, std::memory_order_release); }

 protected:
  bool isOpen() const noexcept { return open_.load(std::memory_order_acquire); }
  void countLost() noexcept { lost_.fetch_add(1, std::memory_order_relaxed); }

 private:
  std::atomic<bool> open_{false};
  std::atomic<std::uint64_t> lost_{0};
};

/// Of ports with values of type T.
template <typename T>
class Tap final : public TapBase {
 public:
  /// The port's writer only; wait-free, never allocates.
  void write(const T& value) noexcept {
    if (isOpen() && !ring_.write({value, monotonicNow()})) countLost();
  }
  const void* next(Nanoseconds& written_at) noexcept override {
    if (!ring_.read(newest_)) return nullptr;
    written_at = newest_.written_at;
    return &newest_.value;
  }

 private:
  struct Written {
    T value{};
    Nanoseconds written_at = 0;
  };
  BufferChannel<Written> ring_{kValues};
  Written newest_;  // reader only
};

}  // namespace knee_robot::rt
