#pragma once

#include <string>

namespace knee_robot::nodes {

/// The path of the file `name` of what a restart must not forget, in the folder `state`, apart from recordings, which
/// somebody may delete to make room. A file that is still with those, in `black_box`, is moved from there. Throws InputError
/// when the folder cannot be made or the file not be moved.
std::string keptIn(const std::string& state, const std::string& black_box, const std::string& name);

}  // namespace knee_robot::nodes
