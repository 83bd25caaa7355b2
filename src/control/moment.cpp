#include "moment.h"

#include <sys/timex.h>

#include <algorithm>
#include <ctime>
#include <fstream>

namespace knee_robot::control {
namespace {

double secondsOf(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

Moment momentNow() {
  Moment now;
  now.wall_s = secondsOf(CLOCK_REALTIME);
  now.since_boot_s = secondsOf(CLOCK_BOOTTIME);
  std::ifstream("/proc/sys/kernel/random/boot_id") >> now.boot;
  timex clock{};  // modes 0: only asks
  now.synchronized = ::adjtimex(&clock) >= 0 && (clock.status & STA_UNSYNC) == 0;
  return now;
}

double leastSecondsBetween(const Moment& then, const Moment& now) {
  const double by_wall_clock = std::max(0.0, now.wall_s - then.wall_s);
  if (then.boot.empty() || now.boot.empty()) return std::min(by_wall_clock, now.since_boot_s);
  if (then.boot == now.boot) return std::max(0.0, now.since_boot_s - then.since_boot_s);
  return then.synchronized && now.synchronized ? std::max(by_wall_clock, now.since_boot_s) : now.since_boot_s;
}

}  // namespace knee_robot::control
