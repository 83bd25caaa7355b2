#include "terminal.h"

#include <ros/console.h>

#include "knee_robot/base/words.h"

namespace knee_robot::nodes {

void showAnswer(const std::string& request, const control::Answer& answer) {
  showOutcome(answer.ok ? request : request + " refused", answer);
}

void showOutcome(const std::string& what, const control::Answer& outcome) {
  const std::string line = printable(what + ": " + outcome.sentence);
  if (outcome.ok) {
    ROS_INFO("%s", line.c_str());
  } else {
    ROS_WARN("%s", line.c_str());
  }
}

}  // namespace knee_robot::nodes
