#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <future>

#include "knee_robot/base/errors.h"
#include "knee_robot/rt/activity.h"

namespace knee_robot::rt {
namespace {

/// The activity whose thread this is; null in ordinary threads.
thread_local const Activity* current_activity = nullptr;

timespec toTimespec(Nanoseconds time) {
  return {static_cast<time_t>(time / kNanosecondsPerSecond), static_cast<long>(time % kNanosecondsPerSecond)};
}

void sleepUntil(Nanoseconds time) noexcept {
  const timespec when = toTimespec(time);
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, nullptr) == EINTR) {
  }
}

/// Touches stack that the cycles may need, so that no page fault happens later.
void prefaultStack() noexcept {
  constexpr int kBytes = 128 * 1024;
  char stack[kBytes];
  volatile char* page = stack;
  for (int i = 0; i < kBytes; i += 1024)
    page[i] = 0;
}

std::string reason(int error) {
  return std::string(" (") + std::strerror(error) + ")";
}

}  // namespace

Nanoseconds monotonicNow() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<Nanoseconds>(now.tv_sec) * kNanosecondsPerSecond + now.tv_nsec;
}

PeriodicActivity::PeriodicActivity(ActivityOptions options) : Activity(std::move(options)) {}

PeriodicActivity::~PeriodicActivity() {
  stop();
}

bool PeriodicActivity::mustHandOver() const noexcept {
  return isActive() && current_activity != this;
}

std::vector<std::string> PeriodicActivity::acquirePrivileges() const {
  std::vector<std::string> lacking;
  if (options_.cpu >= 0) {
    cpu_set_t cpus;
    CPU_ZERO(&cpus);
    CPU_SET(static_cast<unsigned>(options_.cpu), &cpus);
    const int error = pthread_setaffinity_np(pthread_self(), sizeof cpus, &cpus);
    if (error != 0) {
      lacking.push_back("activity " + options_.name + " is not bound to processor " + std::to_string(options_.cpu) +
                        reason(error) + ": give a processor that exists and is allowed");
    }
  }
  if (options_.priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = options_.priority;
    const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
    if (error != 0) {
      lacking.push_back("activity " + options_.name + " runs WITHOUT SCHED_FIFO priority " +
                        std::to_string(options_.priority) + reason(error) +
                        ": give the user an rtprio limit of at least that (/etc/security/limits.d), or run as root");
    }
    if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
      lacking.push_back("activity " + options_.name + " runs WITHOUT locked memory" + reason(errno) +
                        ": give the user an unlimited memlock limit (/etc/security/limits.d), or run as root");
    }
  }
  return lacking;
}

std::vector<std::string> PeriodicActivity::start(Nanoseconds epoch) {
  if (isActive()) throw InputError("activity " + options_.name + " runs already");
  std::promise<std::vector<std::string>> promise;
  std::future<std::vector<std::string>> report = promise.get_future();
  stop_.store(false, std::memory_order_relaxed);
  active_.store(true, std::memory_order_release);
  thread_ = std::thread([this, epoch, &promise] {
    current_activity = this;
    std::vector<std::string> lacking = acquirePrivileges();
    const bool refused = options_.require_real_time && !lacking.empty();
    promise.set_value(std::move(lacking));
    if (!refused) run(epoch);
  });
  std::vector<std::string> lacking = report.get();
  if (options_.require_real_time && !lacking.empty()) {
    stop();
    throw InputError("require_real_time: " + lacking.front());
  }
  return lacking;
}

void PeriodicActivity::stop() {
  if (!thread_.joinable()) return;
  stop_.store(true, std::memory_order_release);
  thread_.join();
  active_.store(false, std::memory_order_release);
}

void PeriodicActivity::run(Nanoseconds epoch) noexcept {
  prefaultStack();
  const Nanoseconds period = options_.period;
  std::int64_t index = std::max<std::int64_t>(0, (monotonicNow() - epoch) / period + 1);
  while (!stop_.load(std::memory_order_acquire)) {
    sleepUntil(epoch + index * period);
    const Nanoseconds wake = monotonicNow() - epoch;
    statistics_.lateness.add(wake - index * period);
    const std::int64_t latest =
        wake / period;  // after a pause of the machine: the cycle of now, not the ones that are lost
    std::int64_t skipped = latest - index;
    index = latest;
    runCycle(index, wake, epoch, true);
    const Nanoseconds end = monotonicNow() - epoch;
    statistics_.execution.add(end - wake);
    const std::int64_t next = std::max(index + 1, end / period + (end % period != 0 ? 1 : 0));
    skipped += next - index - 1;
    skipped > 0 ? countOverrun(skipped) : countPunctual();
    index = next;
  }
}

}  // namespace knee_robot::rt
