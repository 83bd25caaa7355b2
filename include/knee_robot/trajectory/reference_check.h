#pragma once

#include <optional>
#include <string>
#include <vector>

#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/trajectory/reference_file.h"

namespace knee_robot::trajectory {

/// What a reference is checked for, in the order of the checks.
enum class Quantity {
  ShortestLength,  ///< m, against position_min_m
  LongestLength,   ///< m, against position_max_m
  Velocity,        ///< m/s, first differences
  Acceleration,    ///< m/s^2, second differences, at rest before the first and after the last point
  Assembly,        ///< no pose can be followed with these lengths; value: condition number just before
  BaseAngle,       ///< rad, universal joints (legs 1 to 3) and revolute joint (leg 4)
  PlatformAngle,   ///< rad, spherical joints (legs 1 to 3)
  Condition,       ///< condition number of dq/dx (m, rad): the singularity margin
};
const char* nameOf(Quantity quantity);
const char* unitOf(Quantity quantity);

/// Closest approach of one quantity to its limit along a reference.
struct Margin {
  Quantity quantity = Quantity::ShortestLength;
  double value = 0.0;  ///< where it is closest to the limit
  double limit = 0.0;
  int line = 0;      ///< of the file
  int actuator = 0;  ///< 1 to 4; 0: concerns all of them

  /// Share of the limit that is left: 1 far away, 0 at the limit, negative beyond it. Lengths: share of the whole
  /// range.
  double left = 1.0;
};

/// The first limit that a reference violates: of the checks in their order the first, of its points the first.
struct Violation {
  Margin at;
  std::string sentence;  ///< file, line, actuator, value, limit and how to mend it, ready for the user
};

/// Verdict and margins. `lengths` (and `poses`) are what would be played; they are empty when not even the conversion
/// worked.
struct ReferenceCheck {
  std::optional<Violation> violation;
  std::vector<Margin> margins;  ///< of every check that was reached, one a quantity
  Points lengths;               ///< N x 4, m; a bench's missing axes are 0
  Points poses;                 ///< N x 4 by forward kinematics; empty on a bench or when the path cannot be followed

  bool ok() const { return !violation; }
};

/// Actuator lengths (m) that `point` of that space stands for: platform by inverse kinematics, relative with
/// home_length_m added. Precondition: Platform only for a robot with a mechanism.
mechanism::Lengths referenceLengths(const mechanism::Robot& robot, Space space, const mechanism::Vector4& point);

/// Converts a reference to actuator lengths (platform: inverse kinematics; relative: home_length_m added) and checks it
/// against all limits of the robot, between the points too (the Driver interpolates linearly between points, so lengths
/// and first differences are extreme at points; pose, angles and condition are checked at the middle of each interval
/// as well). With h the period: velocity_k = (q_k - q_{k-1}) / h, acceleration_k = (q_{k+1} - 2 q_k + q_{k-1}) / h^2,
/// where the reference is held at its first point before it starts and at its last after it ends. Limits are strict: a
/// file rounded to 1e-6 m adds up to 0.02 m/s^2 of rounding to its second differences, and nothing is allowed for it.
/// Poses are followed from the first point on: a platform file names its own, otherwise the branch in which the robot
/// was built. Never throws for a reference that may not be played; throws InputError when robot and space do not belong
/// together (platform coordinates on a bench).
ReferenceCheck checkReference(const Reference& reference, const mechanism::Robot& robot);

/// The checked lengths; throws InputError(violation's sentence) when the reference may not be played.
ReferenceCheck requirePlayable(const Reference& reference, const mechanism::Robot& robot);

}  // namespace knee_robot::trajectory
