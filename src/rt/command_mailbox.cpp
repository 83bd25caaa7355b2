#include "knee_robot/rt/command_mailbox.h"

#include <chrono>
#include <thread>

namespace knee_robot::rt {
namespace {

using SteadyClock = std::chrono::steady_clock;

Nanoseconds steadyNow() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(SteadyClock::now().time_since_epoch()).count();
}

void nap() {
  std::this_thread::sleep_for(std::chrono::microseconds(100));
}

}  // namespace

CommandMailbox::Answer CommandMailbox::call(Command command, Nanoseconds timeout) {
  const Nanoseconds deadline = steadyNow() + timeout;
  std::uint32_t expected = kFree;
  while (!word_.compare_exchange_strong(expected, static_cast<std::uint32_t>(command) | kPosted,
                                        std::memory_order_acq_rel)) {
    if (steadyNow() > deadline) return Answer::TimedOut;  // another caller's command is not done yet
    expected = kFree;
    nap();
  }
  return awaitAnswer(deadline);
}

CommandMailbox::Answer CommandMailbox::awaitAnswer(Nanoseconds deadline) {
  for (;;) {
    std::uint32_t word = word_.load(std::memory_order_acquire);
    if ((word & kPhase) == kDone) {
      word_.store(kFree, std::memory_order_release);
      return (word & kCommand) != 0 ? Answer::Accepted : Answer::Refused;
    }
    if (steadyNow() > deadline) {
      const bool withdrawn = (word & kPhase) == kPosted;
      const std::uint32_t left = withdrawn ? kFree : (word & kCommand) | kAbandoned;
      if (word_.compare_exchange_strong(word, left, std::memory_order_acq_rel)) return Answer::TimedOut;
      continue;  // it has just been taken or answered
    }
    nap();
  }
}

}  // namespace knee_robot::rt
