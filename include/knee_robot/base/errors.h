#pragma once

#include <stdexcept>
#include <string>

namespace knee_robot {

/// Bad usage or bad input (a file, an option, a service request). what() is one sentence for the user that names file,
/// line, value and limit as far as they exist, and how to mend it. Programs print it on standard error and exit with
/// status 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The input is well-formed, but the data cannot support what was asked (too short, no motion, rank too low).
/// Programs print what() on standard error and exit with status 3.
class Refusal : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Exit statuses of every program.
enum ExitStatus : int { kExitDone = 0, kExitBadInput = 2, kExitRefused = 3 };

}  // namespace knee_robot
