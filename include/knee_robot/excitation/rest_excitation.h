#pragma once

#include <optional>

#include "knee_robot/trajectory/reference_check.h"

namespace knee_robot::excitation {

/// A movement that shows how friction acts near rest: at several places every actuator makes small strokes by itself,
/// slowly, and stands still after each.
struct RestExcitationOptions {
  double duration_s = 90.0;  ///< of the whole movement, with its ways from place to place
  unsigned seed = 1;         ///< same seed and options, same plan
  int places = 4;            ///< other places, other loads at rest
  double velocity_max =
      0.015;  ///< m/s, of strokes; ways from place to place are twice as fast; the robot file's limit holds too
  std::optional<double>
      condition_max;  ///< of dq/dx; default: planningCondition of the robot, whose file's limit holds too
};

/// A planned movement near rest.
struct RestExcitation {
  trajectory::Reference reference;  ///< actuator lengths, checked: it may be played
  trajectory::ReferenceCheck check;
  trajectory::Points places;   ///< actuator lengths of each place, m; row k: the k-th that is visited
  int strokes = 0;             ///< of all actuators
  double resting_share = 0.0;  ///< of the reference's samples in which an actuator stands still, mean over actuators
};

/// Plans it. Strokes are from rest to rest (profiles.h), their ways drawn log-uniformly from 0.03 to 8 mm, so that laws
/// of any width between show, their speeds from 0.3 mm/s to velocity_max, the stops after them from 0.2 to 3 s. Places
/// lie far apart in actuator lengths, the first one farthest from all limits.
/// InputError: options out of range, or a chain. Refusal: the robot's limits leave no room.
RestExcitation planRestExcitation(const mechanism::Robot& robot, const RestExcitationOptions& options = {});

}  // namespace knee_robot::excitation
