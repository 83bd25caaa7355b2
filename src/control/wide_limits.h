#pragma once

#include <string>
#include <vector>

#include "machine_components.h"

namespace knee_robot::control {

/// Between which values a property of a component type may be beside a patient.
struct WideLimit {
  std::string type, property;
  double least, most;
};
std::vector<WideLimit> wideLimits();

/// Limits of the deployment file that an engineer may open for trials, but not beside a patient: what docs/safety.md
/// promises of distances and times was measured with about the defaults. One sentence part each, such as
/// "Supervisor.brake_test_N 0 (at least 60)"; empty: none is open.
std::vector<std::string> limitsOpenedWide(const MachineComponents& machine);

}  // namespace knee_robot::control
