#pragma once

#include <filesystem>
#include <fstream>

#include "test/temporary_folder.h"

namespace knee_robot {

/// Robot file of two axes on a bench; a command of 300 N is all they have.
inline std::filesystem::path writeBenchRobot(const TemporaryFolder& folder) {
  const std::filesystem::path file = folder / "robot.yaml";
  std::ofstream(file)
      << "mechanism: axes\nactuators:\n"
         "  - &axis {position_min_m: 0.0, position_max_m: 0.4, velocity_max_m_per_s: 1.0, acceleration_max_m_per_s2: "
         "10.0, screw_lead_m: 0.010, counts_per_revolution: 5000, home_length_m: 0.1, force_per_volt_N: 100.0, "
         "voltage_max_V: 10, force_max_N: 300}\n  - *axis\n";
  return file;
}

}  // namespace knee_robot
