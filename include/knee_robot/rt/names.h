#pragma once

#include <string>

#include "knee_robot/base/words.h"

namespace knee_robot::rt {

/// "a, b, c" of pointers to components, ports, properties or activities; "none" where there are none.
template <typename Named>
std::string listNames(const Named& all) {
  const std::string list = joined(all, [](const auto& one) { return one->name(); });
  return list.empty() ? "none" : list;
}

}  // namespace knee_robot::rt
