#pragma once

#include <string>

#include "knee_robot/mechanism/robot.h"
#include "knee_robot/simulation/axis_path.h"
#include "knee_robot/simulation/virtual_plant.h"

namespace knee_robot::simulation {

/// How the virtual plant's motion is recorded.
struct VirtualRecorder {
  double period_s = 0.01;       ///< between rows
  bool exact_encoders = false;  ///< true: positions as they are; false: whole encoder counts from home
  double force_noise_N = 0.0;   ///< standard deviation of the noise added to every recorded force, independent per row
  unsigned seed = 1;            ///< of that noise
};

/// What happened on the way, for the program's last line.
struct VirtualRun {
  int rows = 0;
  mechanism::Vector4 force_rms = mechanism::Vector4::Zero();  ///< N, of the rows
  mechanism::Vector4 force_max = mechanism::Vector4::Zero();  ///< N, largest magnitude of the rows
  double dissipated_J = 0.0;
  double energy_error_J =
      0.0;  ///< largest |motor work - dissipated - gain of energy|: what the instants do not resolve
};

/// Moves the plant along `path` and writes a recording (docs/contract.md, section 2). A row's position is that of its
/// instant; its force is the mean over the interval until the next row, in which a command holds, taken at instants at
/// most 1 ms apart. command_V is that force as voltage. InputError when the file exists; Refusal when the closed
/// mechanism cannot follow the path.
VirtualRun recordVirtualPlant(const mechanism::Robot& robot, VirtualPlant& plant, const AxisPath& path,
                              const VirtualRecorder& recorder, const std::string& file);

}  // namespace knee_robot::simulation
