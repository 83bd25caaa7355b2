#pragma once

#include <string>
#include <vector>

namespace knee_robot::report {

/// How a robot's results are labelled. Empty vectors: in m and N, nothing to translate.
struct RecordedUnits {
  std::vector<std::string> force;  ///< per actuator: N, Nm or A
  std::vector<char> revolute;      ///< per actuator
  std::vector<std::string> joints;

  bool plain() const { return force.empty(); }
  /// The force's unit where all actuators have the same; empty where they differ.
  std::string commonForce() const;
  bool allRevolute() const;
};

}  // namespace knee_robot::report
