#pragma once

#include <atomic>
#include <cstdint>

#include "knee_robot/rt/cycle.h"

namespace knee_robot::rt {

/// Life-cycle commands that another thread may hand to a component's activity.
enum class Command : std::uint8_t { Configure = 1, Start, Stop, Recover };

/// One-place mailbox from any number of ordinary threads to one real-time thread. The real-time side is wait-free: one
/// load when nothing is posted. The ordinary side sleeps and polls.
///
/// Life of the word: Free -> Posted -> Serving -> Done -> Free. A caller that gives up while the command is being
/// served marks it Abandoned, and the server frees it. Posting is a release, taking an acquire, and the same for the
/// answer: what the caller wrote before call() is visible to the hook, what the hook wrote is visible after call().
class CommandMailbox {
 public:
  enum class Answer { Accepted, Refused, TimedOut };

  /// Ordinary threads: posts `command` and waits for the answer, at most `timeout`. A command that timed out before it
  /// was taken is withdrawn and will not be executed later.
  Answer call(Command command, Nanoseconds timeout);

  /// Real-time thread: executes a posted command by `execute(Command) -> bool`, which must not throw.
  template <typename Execute>
  void serve(Execute&& execute) noexcept {
    std::uint32_t word = word_.load(std::memory_order_acquire);
    if ((word & kPhase) != kPosted) return;
    const std::uint32_t command = word & kCommand;
    if (!word_.compare_exchange_strong(word, command | kServing, std::memory_order_acq_rel)) return;  // withdrawn
    const bool accepted = execute(static_cast<Command>(command));
    word = command | kServing;
    const std::uint32_t done = kDone | (accepted ? 1u : 0u);
    if (!word_.compare_exchange_strong(word, done, std::memory_order_acq_rel)) {
      word_.store(kFree, std::memory_order_release);  // abandoned by its caller
    }
  }

 private:
  static constexpr std::uint32_t kCommand = 0x00ff;
  static constexpr std::uint32_t kPhase = 0xff00;
  static constexpr std::uint32_t kFree = 0x0000, kPosted = 0x0100, kServing = 0x0200, kDone = 0x0400,
                                 kAbandoned = 0x0800;

  Answer awaitAnswer(Nanoseconds deadline);

  std::atomic<std::uint32_t> word_{kFree};
};

}  // namespace knee_robot::rt
