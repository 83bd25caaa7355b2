#pragma once

#include <functional>

#include "knee_robot/rt/deployer.h"

namespace knee_robot::control {

/// Lets time pass: waits for a machine that runs in threads, executes the cycles of a stepped one, whose plant moves on
/// with it.
class CycleRunner {
 public:
  /// `now_and_then`: what threads would do beside the cycles; every 64 steps. `deployment` must outlive this.
  CycleRunner(rt::Deployment& deployment, std::function<void()> now_and_then)
      : deployment_(deployment), now_and_then_(std::move(now_and_then)) {}

  /// Of the deployment's clock; of a stepped one the time of the next cycle: what was paused for has passed.
  rt::Nanoseconds now() const noexcept {
    return deployment_.execution() == rt::Execution::Stepped ? deployment_.nextRelease() : deployment_.now();
  }
  /// Stepped only. `advance` is called before each cycle with the virtual time (ns) up to which the plant has to be
  /// moved on.
  void setPlant(std::function<void(rt::Nanoseconds time)> advance) { advance_plant_ = std::move(advance); }
  /// Stepped only: executes the next cycle, answers its virtual time.
  rt::Nanoseconds step();
  /// Stepped only: executes all cycles of the next `seconds`.
  void run(double seconds);
  /// Stepped only: the next `seconds` go by without a cycle.
  void pause(double seconds) { deployment_.skip(rt::fromSeconds(seconds)); }
  /// Whether `done` came true within `timeout_s`.
  bool waitUntil(const std::function<bool()>& done, double timeout_s);

 private:
  rt::Deployment& deployment_;
  const std::function<void()> now_and_then_;
  std::function<void(rt::Nanoseconds)> advance_plant_;
  int steps_ = 0;
};

}  // namespace knee_robot::control
