#pragma once

#include <cstdint>
#include <string>

#include "command_line.h"

namespace knee_robot::nodes {

/// What the simulated robots have in common, behind cards or behind drives on a bus.
struct SimulatorOptions {
  std::string robot, simulation, shm = "/knee_robot_sim";
  double duration_s = 0.0;
  int priority = 0, cpu = -1;
  std::uint64_t truth_rows = 0;
};

/// `shm`: what the shared memory is for, as --help says it.
void declareSimulator(CommandLine& app, const std::string& shm, SimulatorOptions& options);

/// A processor, a real-time priority and locked memory are asked for, never needed: the robot is late without them, and says so.
void askForRealTime(const std::string& program, const SimulatorOptions& options);

}  // namespace knee_robot::nodes
