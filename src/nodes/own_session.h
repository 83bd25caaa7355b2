#pragma once

namespace knee_robot::nodes {

/// The argument that asks for it; launch files of the real robot give it to controller and guardian.
constexpr const char* kOwnSession = "--own-session";

/// What a process does that must not end before it has handed over its load, whoever started it. roslaunch kills the
/// process group of a node that has not ended 17 s after Ctrl-C; a controller behind a brake that does not hold carries
/// the platform for longer than that (docs/safety.md).
///
/// Returns at once unless kOwnSession is among the arguments. Otherwise it forks: the process that goes on from here
/// has a session, and so a process group, of its own. The one that stays in the starter's group hands INT, TERM, HUP and
/// QUIT on and ends as the other one does; when it is killed, the other one gets SIGTERM. First in main, before there
/// are threads. When there can be no further process it says so and ends the program with status 1.
void continueInOwnSession(int argc, const char* const* argv);

}  // namespace knee_robot::nodes
