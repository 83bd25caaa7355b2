#pragma once

#include <string>

namespace knee_robot::control {

/// Answer to an operator's command: done or begun, or why not; one sentence for the operator either way.
struct Answer {
  bool ok = false;
  std::string sentence;
};

}  // namespace knee_robot::control
