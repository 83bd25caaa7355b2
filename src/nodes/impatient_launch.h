#pragma once

#include <string>

namespace knee_robot::nodes {

/// roslaunch kills what has not ended 17 s after Ctrl-C, the guardian with it. A controller whose holding brakes do not
/// hold goes on carrying the platform for longer than that (docs/safety.md): killed then, drives stay on with nobody in
/// charge. `command` is a process' command line as in /proc/PID/cmdline, its arguments separated by zeros. True: it is a
/// roslaunch that was not told to wait.
bool killsTooSoon(const std::string& command);

/// Of the process that has started this one.
std::string commandOfParent();

}  // namespace knee_robot::nodes
