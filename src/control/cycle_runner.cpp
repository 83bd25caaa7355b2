#include "cycle_runner.h"

#include <chrono>
#include <thread>

namespace knee_robot::control {
namespace {

constexpr int kNowAndThen = 64;  // steps

}  // namespace

rt::Nanoseconds CycleRunner::step() {
  if (advance_plant_) advance_plant_(deployment_.nextRelease());
  const rt::Nanoseconds time = deployment_.step();
  if (++steps_ % kNowAndThen == 0) now_and_then_();
  return time;
}

void CycleRunner::run(double seconds) {
  const rt::Nanoseconds end = deployment_.nextRelease() + rt::fromSeconds(seconds);
  while (deployment_.nextRelease() < end)
    step();
}

bool CycleRunner::waitUntil(const std::function<bool()>& done, double timeout_s) {
  if (deployment_.execution() == rt::Execution::Stepped) {
    const rt::Nanoseconds end = deployment_.nextRelease() + rt::fromSeconds(timeout_s);
    while (!done()) {
      if (deployment_.nextRelease() >= end) return false;
      step();
    }
    return true;
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  while (!done()) {
    if (std::chrono::steady_clock::now() >= end) return done();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace knee_robot::control
