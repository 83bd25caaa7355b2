#include "down_now.h"

#include <chrono>
#include <thread>

#include "knee_robot/hardware/machine_lock.h"
#include "knee_robot/hardware/process_watch.h"
#include "knee_robot/rt/activity.h"

namespace knee_robot::nodes {
namespace {

bool lives(const std::atomic<std::int32_t>& pid) {
  const std::int32_t process = pid.load();
  return process > 0 && !hardware::ProcessWatch().isGone(process);
}

}  // namespace

bool guardianActs(const hardware::GuardianLink& link) {
  const std::int32_t guardian = link.guardian_pid.load();
  const std::uint64_t cycles = link.guardian_cycles.load();
  if (guardian <= 0 || hardware::ProcessWatch().isGone(guardian)) return false;
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  return link.guardian_cycles.load() != cycles;
}

bool letControllerStop(const hardware::GuardianLink& link) {
  constexpr rt::Nanoseconds kLongest = 1'500'000'000, kSilence = 20'000'000;
  const rt::Nanoseconds began = rt::monotonicNow();
  rt::Nanoseconds heard = began;
  std::uint64_t heartbeat = link.heartbeat.load();
  hardware::ProcessWatch watch;
  while (link.armed.load() != 0 && link.tripped.load() == 0) {
    const std::int32_t controller = link.controller_pid.load();
    if (controller == 0 || watch.isGone(controller) || rt::monotonicNow() - heard > kSilence) return true;
    if (rt::monotonicNow() - began > kLongest) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const std::uint64_t now = link.heartbeat.load();
    if (now != heartbeat) heard = rt::monotonicNow();
    heartbeat = now;
  }
  return true;
}

void letGuardianSee(const hardware::GuardianLink& link) {
  const std::uint64_t cycles = link.guardian_cycles.load();
  for (int ms = 0; ms < 200 && link.guardian_cycles.load() - cycles < 2; ++ms)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

bool isBesideAStranger(const hardware::GuardianLink* link, const std::string& machine) {
  using hardware::MachineLock;
  constexpr rt::Nanoseconds kLongest = 3'000'000'000;  // a hand-over takes 2.1 s at most
  const rt::Nanoseconds began = rt::monotonicNow();
  const bool knows_guardian = link != nullptr && lives(link->guardian_pid);
  do {
    if (!(link != nullptr && lives(link->controller_pid)) && MachineLock::isTaken("controller", machine)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  } while (!knows_guardian && MachineLock::isTaken("guardian", machine) && rt::monotonicNow() - began < kLongest);
  return false;
}

}  // namespace knee_robot::nodes
