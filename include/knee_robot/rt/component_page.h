#pragma once

#include <string>

#include "knee_robot/rt/deployer.h"

namespace knee_robot::rt {

/// What every component type of `types` says of itself, as Markdown: ports, properties, operations. Makes one of each.
/// Not real-time.
std::string componentPage(const TypeFactory& types);

}  // namespace knee_robot::rt
