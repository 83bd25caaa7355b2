#pragma once

#include <string>

#include "knee_robot/control/answer.h"

namespace knee_robot::nodes {

/// The one way of answers to the terminal, and to /rosout: they hold words of whoever asked, such as names of files, and
/// these cannot command a terminal or forge a line of the log.
///
/// The answer to a request: done, or refused.
void showAnswer(const std::string& request, const control::Answer& answer);
/// How something that had begun has ended.
void showOutcome(const std::string& what, const control::Answer& outcome);

}  // namespace knee_robot::nodes
