#pragma once

#include <string>
#include <vector>

#include "knee_robot/control/axis_data.h"

namespace knee_robot::control {

/// What the operator is to know of a disturbance.
struct Notice {
  enum class Level { Warning, Error };
  Level level;
  std::string sentence;
};

/// In plain words, the gravest first; empty: nothing, or nothing is known. Ordinary threads.
std::vector<Notice> noticesOf(const Disturbance& disturbance);
/// What to say where there are no notices: that all is well, or why nobody can tell.
const char* sentenceWithoutNotices(const Disturbance& disturbance) noexcept;

}  // namespace knee_robot::control
