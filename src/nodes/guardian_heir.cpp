#include "guardian_heir.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <thread>

#include "knee_robot/rt/activity.h"
#include "signals.h"

namespace knee_robot::nodes {
namespace {

constexpr rt::Nanoseconds kStep = 1'000'000;
constexpr rt::Nanoseconds kControllersTime = 2'000'000'000;  // to miss its guardian, and to stop
constexpr rt::Nanoseconds kStandstill = 100'000'000;         // of guardian and controller, while the heir runs
constexpr rt::Nanoseconds kRefused = 200'000'000;            // for an heir that has just begun
constexpr rt::Nanoseconds kHeirsTime = 4'000'000'000;        // a hand-over takes 2.1 s at most

void oneStep() {
  std::this_thread::sleep_for(std::chrono::nanoseconds(kStep));
}

bool lives(std::int32_t pid) noexcept {
  return pid > 0 && pid != ::getpid() && !hardware::ProcessWatch().isGone(pid);
}

bool isOn(const hardware::GuardianLink& link) noexcept {
  return link.acts.load() != 0 || (link.armed.load() != 0 && link.tripped.load() == 0);
}

/// Waits as long as a controller that lives may stop by itself. False: there is nothing to be done, or somebody else
/// does it.
bool isLeftToTheHeir(const hardware::GuardianLink& link, rt::Nanoseconds silence) {
  const rt::Nanoseconds began = rt::monotonicNow();
  rt::Nanoseconds looked = began, silent = 0;
  std::uint64_t heartbeat = link.heartbeat.load();
  hardware::ProcessWatch controller;
  while (isOn(link) && !lives(link.guardian_pid.load())) {
    const std::int32_t pid = link.controller_pid.load();
    if (link.acts.load() != 0 || pid <= 0 || controller.isGone(pid) || silent > silence) return true;
    if (looked - began > kControllersTime) return false;
    oneStep();
    const std::uint64_t latest = link.heartbeat.load();
    const rt::Nanoseconds now = rt::monotonicNow();
    silent =
        latest != heartbeat ? 0 : silent + std::min(now - looked, 2 * kStep);  // a pause of the machine is no silence
    looked = now;
    heartbeat = latest;
  }
  return false;
}

/// What ends the guardian must not end its heir.
void leaveTheGuardian() {
  ::setsid();
  ::prctl(PR_SET_NAME, "guardian_heir");
  takeSignals(SIG_IGN);
}

/// Real time as far as it is to be had: the guardian itself says what is lacking.
void takePriority(int priority) {
  if (priority <= 0) return;
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (::sched_setscheduler(0, SCHED_FIFO, &parameters) == 0 && ::mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    // pages that are missing are read then
  }
}

void tellTakingOver(const char* what) {
  std::printf("guardian: the guardian %s while drives are on: process %d hands over to the brakes\n", what, ::getpid());
  std::fflush(stdout);
}

/// As the guardian, which this process is in `link`.
void guardUntilDown(hardware::GuardianLink& link, hardware::EmergencyOutputs& outputs,
                    const control::GuardianCarry& carry, rt::Nanoseconds silence) {
  control::Guardian own(link, outputs, silence, kStep, rt::monotonicNow, carry);
  own.configure();
  own.start();
  const rt::Nanoseconds began = rt::monotonicNow();
  const auto waits = [&] { return link.tripped.load() == 0 && rt::monotonicNow() - began < silence + 20 * kStep; };
  do {
    own.update({rt::monotonicNow(), rt::monotonicNow(), kStep});
    oneStep();
  } while (own.report().acts.load() || (link.armed.load() != 0 && waits()));
}

/// Guardian and controller stand still together while this process does not, or the guardian does in the middle of a
/// hand-over. A pause of the machine counts as one look.
class Standstill {
 public:
  explicit Standstill(rt::Nanoseconds limit) : limit_(limit) {}

  bool look(const hardware::GuardianLink& link) noexcept {
    const std::uint64_t cycles = link.guardian_cycles.load(), heartbeat = link.heartbeat.load();
    const bool moves = cycles != cycles_ || (heartbeat != heartbeat_ && link.acts.load() == 0) || !isOn(link);
    const rt::Nanoseconds now = rt::monotonicNow();
    silence_ = moves ? 0 : silence_ + std::min(now - looked_, 2 * kLook);
    looked_ = now;
    cycles_ = cycles;
    heartbeat_ = heartbeat;
    return silence_ >= limit_;
  }

  static constexpr rt::Nanoseconds kLook = 5'000'000;

 private:
  const rt::Nanoseconds limit_;
  std::uint64_t cycles_ = 0, heartbeat_ = 0;
  rt::Nanoseconds looked_ = 0, silence_ = 0;
};

/// Waits until the guardian has ended (true), or stands still with what is on (false). `open_end` is closed before the
/// process counts as gone.
bool waitForTheEnd(const hardware::GuardianLink& link, std::int32_t guardian, int open_end, rt::Nanoseconds limit) {
  hardware::ProcessWatch watch;
  watch.isGone(guardian);
  Standstill standstill(limit);
  pollfd closed{open_end, POLLIN, 0};
  while (::poll(&closed, 1, static_cast<int>(Standstill::kLook / 1'000'000)) <= 0) {
    if (standstill.look(link)) return false;
  }
  while (!watch.isGone(guardian))
    oneStep();
  return true;
}

/// The whole life of the second process.
void beHeir(hardware::GuardianLink& link, std::int32_t guardian, int open_end,
            const std::function<GuardianHeir()>& open) {
  leaveTheGuardian();
  const GuardianHeir heir = open();
  takePriority(heir.priority);
  const bool ended = waitForTheEnd(link, guardian, open_end, std::max(kStandstill, 3 * heir.silence));
  std::int32_t found = guardian;
  if (!ended && link.guardian_pid.compare_exchange_strong(found, ::getpid())) {
    tellTakingOver("stands still");
    guardUntilDown(link, *heir.outputs, heir.carry, heir.silence);
  }
  while (ended && isLeftToTheHeir(link, heir.silence)) {
    tellTakingOver("has died");
    handOverInItsPlace(link, *heir.outputs, heir.carry, 2 * kStep);  // the silence has been waited for
  }
  std::int32_t mine = ::getpid();
  link.guardian_pid.compare_exchange_strong(mine, 0);
}

}  // namespace

std::int32_t takeGuard(hardware::GuardianLink& link) {
  const rt::Nanoseconds began = rt::monotonicNow();
  rt::Nanoseconds acted = began;
  std::int32_t other = link.guardian_pid.load();
  while (other != ::getpid()) {
    if (!lives(other)) {  // a zombie guards nothing; in a container its number may be reused
      if (link.guardian_pid.compare_exchange_strong(other, ::getpid())) break;
      continue;
    }
    const rt::Nanoseconds now = rt::monotonicNow();
    if (link.acts.load() != 0) acted = now;
    if (now - acted > kRefused || now - began > kHeirsTime) return other;
    oneStep();
    other = link.guardian_pid.load();
  }
  return 0;
}

void handOverInItsPlace(hardware::GuardianLink& link, hardware::EmergencyOutputs& outputs,
                        const control::GuardianCarry& carry, rt::Nanoseconds silence) {
  std::int32_t guardian = link.guardian_pid.load();
  if (lives(guardian) || !link.guardian_pid.compare_exchange_strong(guardian, ::getpid())) return;
  guardUntilDown(link, outputs, carry, silence);
}

std::int32_t keepHeir(hardware::GuardianLink& link, const std::function<GuardianHeir()>& open) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return -1;
  const pid_t guardian = ::getpid(), child = ::fork();
  if (child != 0) {  // the end that is open as long as this process lives
    ::close(ends[0]);
    if (child < 0) ::close(ends[1]);
    return child;
  }
  ::close(ends[1]);
  try {
    beHeir(link, guardian, ends[0], open);
  } catch (const std::exception&) {
    // the machine cannot be opened: the guardian says so
  }
  ::_exit(0);
}

}  // namespace knee_robot::nodes
