#pragma once

#include <functional>
#include <string>

#include "command_line.h"

namespace knee_robot::nodes {

/// What every program's main does around its work: parses the command line into `app`'s options, runs `body`, and turns
/// what is thrown into one line on standard error ("NAME: sentence") and an exit status: bad command line or InputError
/// 2, Refusal 3, anything else 1, output that could not be written included, unless the program serves. `--help` prints and returns 0. Otherwise the status that `body` returns.
/// Of a program that allows extras, only remappings of ROS (__name:=...), which roslaunch appends, are accepted.
///
///     CommandLine app("says whether a reference may be played", "check_reference");
///     std::string robot;
///     app.option("--robot", robot, "robot file").required();
///     return runProgram(app, argc, argv, [&] { ...; return kExitDone; });
int runProgram(CommandLine& app, int argc, const char* const* argv, const std::function<int()>& body);

/// Where one of the three standard streams is closed, /dev/null takes its place: the next file or socket that is opened
/// would get its number otherwise, and with it everything that is printed. Before anything is opened.
void openStandardStreams();

/// As many descriptors as the process may have, up to 4096: more than the usual 1024, for connections that say nothing;
/// not the thousand millions of some containers, for each of which the ROS library keeps and searches 8 bytes, in
/// locked memory. Before ros::init.
void limitDescriptors();

/// "rosrun knee_robot PROGRAM ARGUMENTS...", for reports that say how they were made.
std::string commandLine(const std::string& program, int argc, const char* const* argv);

}  // namespace knee_robot::nodes
