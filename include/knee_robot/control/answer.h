#pragma once

#include <cstdint>
#include <string>

namespace knee_robot::control {

/// Answer to an operator's command: done or begun, or why not; one sentence for the operator either way.
struct Answer {
  bool ok = false;
  std::string sentence;
};

/// Answer about a reference file that was written.
struct SavedReference : Answer {
  std::uint32_t points = 0;
  double duration_s = 0.0;
};

}  // namespace knee_robot::control
