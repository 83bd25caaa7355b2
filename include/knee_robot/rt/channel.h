#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <type_traits>
#include <vector>

namespace knee_robot::rt {

/// One connection: exactly one writing and one reading thread. Everything is allocated at construction.
template <typename T>
class Channel {
 public:
  virtual ~Channel() = default;
  /// False when a value was lost for want of room.
  virtual bool write(const T& value) noexcept = 0;
  /// False when there is nothing new; `value` is then untouched.
  virtual bool read(T& value) noexcept = 0;
};

/// Keeps the newest value: triple buffer, wait-free on both sides.
/// The writer fills its own slot and exchanges it with the middle one (release: the slot's content comes along;
/// acquire: the reader has left the slot that comes back). The reader exchanges its slot with the middle one in the
/// same way.
template <typename T>
class DataChannel final : public Channel<T> {
 public:
  bool write(const T& value) noexcept override {
    slots_[back_] = value;
    back_ = middle_.exchange(static_cast<std::uint8_t>(back_ | kFresh), std::memory_order_acq_rel) & kIndex;
    return true;
  }
  bool read(T& value) noexcept override {
    if (!(middle_.load(std::memory_order_relaxed) & kFresh)) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    value = slots_[front_];
    return true;
  }

 private:
  static constexpr std::uint8_t kFresh = 4, kIndex = 3;
  std::array<T, 3> slots_{};
  std::uint8_t back_ = 0;   // writer only
  std::uint8_t front_ = 1;  // reader only
  alignas(64) std::atomic<std::uint8_t> middle_{2};
};

/// Keeps the oldest n values: single-producer single-consumer ring, wait-free on both sides; a full ring refuses.
/// Each side publishes its index with release after touching the slot and reads the other's with acquire before.
template <typename T>
class BufferChannel final : public Channel<T> {
 public:
  explicit BufferChannel(std::size_t capacity) : slots_(capacity + 1) {}
  bool write(const T& value) noexcept override {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    const std::size_t next = head + 1 == slots_.size() ? 0 : head + 1;
    if (next == tail_.load(std::memory_order_acquire)) return false;
    slots_[head] = value;
    head_.store(next, std::memory_order_release);
    return true;
  }
  bool read(T& value) noexcept override {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    value = slots_[tail];
    tail_.store(tail + 1 == slots_.size() ? 0 : tail + 1, std::memory_order_release);
    return true;
  }

 private:
  std::vector<T> slots_;
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace knee_robot::rt
