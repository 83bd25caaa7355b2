#pragma once

#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include "knee_robot/control/control_system.h"

namespace knee_robot::nodes {

/// Pauses of the machine that a stepped controller runs on, at random times: no cycle is executed and no row recorded,
/// the robot goes on with the forces that it has.
class Pauses {
 public:
  struct Options {
    double per_minute = 0.0;   ///< on the average; 0: none
    double longest_s = 0.018;  ///< lengths are uniform from 1 ms to this
    unsigned seed = 1;
  };
  explicit Pauses(const Options& options)
      : options_(options), random_(options.seed), length_s_(1e-3, options.longest_s), next_s_(spacing_s()) {}

  /// Executes cycles until the robot holds or has a fault, for `patience_s` of simulated time at most.
  void waitWhileBusy(control::ControlSystem& system, double patience_s) {
    using control::MachineState;
    const double begin = rt::toSeconds(system.step());
    for (double now = 0.0; now < patience_s; now = rt::toSeconds(system.step()) - begin) {
      const MachineState state = system.state();
      if (state == MachineState::Holding || state == MachineState::Faulted) return;
      if (now < next_s_) continue;
      const double length = length_s_(random_);
      system.pause(length);
      ++count_;
      next_s_ = now + length + spacing_s();
    }
  }
  void print() const {
    if (options_.per_minute > 0.0) std::printf("playing, pauses of the machine: %d\n", count_);
  }

 private:
  double spacing_s() {
    if (options_.per_minute <= 0.0) return std::numeric_limits<double>::infinity();
    return std::exponential_distribution<double>(options_.per_minute / 60.0)(random_);
  }

  Options options_;
  std::mt19937 random_;
  std::uniform_real_distribution<double> length_s_;
  double next_s_;
  int count_ = 0;
};

}  // namespace knee_robot::nodes
