#pragma once

#include <vector>

#include "knee_robot/tracing/hypothesis.h"

namespace knee_robot::tracing {

/// How far one candidate at one place is from what the base parameters can do, and from the other candidates there,
/// along the training recordings. Columns low-passed, weighed by each actuator's noise; of every candidate the shape
/// that explains most of the baseline's residual. Angles in rad.
struct PlaceAngles {
  Place place;
  double base_smallest =
      0.0;  ///< smallest principal angle to the base space: 0 when some combination is absorbed altogether
  double base_largest = 0.0;  ///< largest: near 0 when everything is absorbed
  /// A place that explains nearly the same.
  struct Neighbour {
    Place place;
    double angle = 0.0;  ///< smallest principal angle after the base is taken out of both
  };
  std::vector<Neighbour> nearest;  ///< at most three, nearest first; same actuator, or shared
};

/// For every place of named effects. Places that leave nothing beside the base have no neighbours.
std::vector<PlaceAngles> principalAngles(const TraceData& data, const std::vector<PlaceColumns>& places,
                                         const Projection& base, const Eigen::VectorXd& noise_N);

}  // namespace knee_robot::tracing
