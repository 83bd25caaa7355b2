#include "check_sentences.h"

#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::trajectory {
namespace {

bool lengthsInRange(const mechanism::Robot& robot, const mechanism::Lengths& lengths) {
  for (int i = 0; i < robot.axes(); ++i) {
    const mechanism::Actuator& actuator = robot.actuators[i];
    if (!(lengths[i] >= actuator.position_min_m && lengths[i] <= actuator.position_max_m)) return false;
  }
  return true;
}

/// A file that is out of range at its first point is often one of another space: says so when that would fit.
std::string otherSpaceHint(const Reference& reference, const mechanism::Robot& robot) {
  for (const Space space : {Space::Actuator, Space::Platform, Space::Relative}) {
    if (space == reference.space) continue;
    if (space == Space::Platform && robot.kind != mechanism::MechanismKind::ThreeUpsOneRpu) continue;
    const mechanism::Lengths lengths = referenceLengths(robot, space, reference.points.row(0).transpose());
    if (lengthsInRange(robot, lengths)) {
      return std::string(" (its first point would be in range with --space ") + nameOf(space) + ")";
    }
  }
  return "";
}

constexpr double kMillimetres = 100.0;  ///< times the limit: no slip of a reference, but another unit

std::string lengthSentence(const Margin& at, const Reference& reference, const mechanism::Robot& robot) {
  const bool below = at.quantity == Quantity::ShortestLength;
  std::string sentence = "actuator " + std::to_string(at.actuator) + " is sent to " + shortNumber(at.value, 7) +
                         " m, " + (below ? "below its minimum of " : "above its maximum of ") +
                         shortNumber(at.limit, 7) + " m in " + robot.path +
                         (std::abs(at.value) > kMillimetres * std::abs(at.limit)
                              ? "; is the reference in millimetres? Its lengths are m"
                              : std::string("; move the reference ") + (below ? "up" : "down") + " by " +
                                    shortNumber(std::abs(at.value - at.limit), 3) + " m");
  if (at.line == reference.first_line) sentence += otherSpaceHint(reference, robot);
  return sentence;
}

/// Both with so many digits that they differ.
std::pair<std::string, std::string> apart(double value, double limit) {
  constexpr int kFewest = 4, kMost = 12;
  int digits = kFewest;
  while (digits < kMost && shortNumber(value, digits) == shortNumber(limit, digits))
    ++digits;
  return {shortNumber(value, digits), shortNumber(limit, digits)};
}

std::string differenceSentence(const Margin& at, const mechanism::Robot& robot) {
  const bool velocity = at.quantity == Quantity::Velocity;
  const double factor = velocity ? at.value / at.limit : std::sqrt(at.value / at.limit);
  const auto [value, limit] = apart(at.value, at.limit);
  return "actuator " + std::to_string(at.actuator) + (velocity ? " moves with " : " accelerates with ") + value + " " +
         unitOf(at.quantity) + ", beyond its limit of " + limit + " " + unitOf(at.quantity) + " in " + robot.path +
         "; remove the jump, or slow the reference down " + shortNumber(std::ceil(factor * 100.0) / 100.0, 4) +
         " times";
}

std::string angleSentence(const Margin& at, const mechanism::Robot& robot) {
  const char* joint = at.quantity == Quantity::PlatformAngle ? "spherical"
                      : at.actuator == 4                     ? "revolute"
                                                             : "universal";
  const auto [value, limit] = apart(at.value * kDegrees, at.limit * kDegrees);
  return std::string("the ") + joint + " joint of leg " + std::to_string(at.actuator) + " is bent by " + value +
         " deg, beyond its limit of " + limit + " deg in " + robot.path + "; reduce the movement";
}

}  // namespace

const char* nameOf(Quantity quantity) {
  switch (quantity) {
    case Quantity::ShortestLength:
      return "shortest length";
    case Quantity::LongestLength:
      return "longest length";
    case Quantity::Velocity:
      return "velocity";
    case Quantity::Acceleration:
      return "acceleration";
    case Quantity::Assembly:
      return "assembly";
    case Quantity::BaseAngle:
      return "base joint angle";
    case Quantity::PlatformAngle:
      return "platform joint angle";
    case Quantity::Condition:
      return "singularity (condition)";
  }
  return "";
}

const char* unitOf(Quantity quantity) {
  switch (quantity) {
    case Quantity::ShortestLength:
    case Quantity::LongestLength:
      return "m";
    case Quantity::Velocity:
      return "m/s";
    case Quantity::Acceleration:
      return "m/s2";
    case Quantity::BaseAngle:
    case Quantity::PlatformAngle:
      return "rad";
    case Quantity::Assembly:
    case Quantity::Condition:
      break;
  }
  return "";
}

std::string violationSentence(const Margin& at, const Reference& reference, const mechanism::Robot& robot) {
  const std::string where = reference.name + ":" + std::to_string(at.line) + ": ";
  switch (at.quantity) {
    case Quantity::ShortestLength:
    case Quantity::LongestLength:
      return where + lengthSentence(at, reference, robot);
    case Quantity::Velocity:
    case Quantity::Acceleration:
      return where + differenceSentence(at, robot);
    case Quantity::BaseAngle:
    case Quantity::PlatformAngle:
      return where + angleSentence(at, robot);
    case Quantity::Condition:
      return where + "the condition number of dq/dx is " + shortNumber(at.value, 4) +
             ", beyond the singularity margin of " + shortNumber(at.limit, 4) + " in " + robot.path +
             "; keep further away from the singularity";
    case Quantity::Assembly:
      break;
  }
  if (at.line == reference.first_line) {
    return where + "no pose of " + robot.path + " near its home branch has these lengths; check that the reference " +
           "belongs to this robot" + (reference.space == Space::Relative ? " and that home_length_m is right" : "");
  }
  return where + "the path crosses or touches a singularity of " + robot.path + " (condition number " +
         shortNumber(at.value, 4) + " just before); lead it around, on the side where it starts";
}

}  // namespace knee_robot::trajectory
