#pragma once

#include <string>
#include <string_view>

namespace knee_robot::recording {

/// What makes a text that should begin with a recording's header another kind of table, and how to make a recording of
/// it, as the end of a sentence; empty when nothing does.
std::string foreignText(std::string_view content);

}  // namespace knee_robot::recording
