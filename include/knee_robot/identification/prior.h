#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "knee_robot/identification/columns.h"

namespace knee_robot::identification {

constexpr double kOffsetShare = 0.1;  ///< of the rms force: an offset that is as large as the prior

/// What is known before any recording. Columns without a physical sign (rigid bodies, offsets) have unit coordinates u
/// in which the prior is a ball: parameters = mean + transform * u, and |u| = 1 is a change as large as the prior
/// itself. Rigid bodies:
/// PhysicalCoordinates, the first order of the log-Cholesky parametrisation around a body that can exist. Friction and
/// rotors have no prior but their sign.
struct Prior {
  Eigen::VectorXd mean;       ///< one per column
  Eigen::MatrixXd transform;  ///< columns x unit coordinates
  int links = 0;              ///< unit coordinates of what carries nothing but itself, the first ones: not the platform
  /// Largest |u| of a link that is believed, whatever held-back data say: where the bodies were drawn, three times
  /// what was drawn. Infinite where only the order of magnitude is claimed, and of a chain, which may carry a payload.
  double largest_change = std::numeric_limits<double>::infinity();
};

/// Of the robot's URDF; without one, of bodies of which only the order of magnitude is claimed (5 kg a link, 10 kg the
/// platform, radius of gyration 0.2 m, centred in their frames). `force_rms_N`, per actuator: an offset of a tenth of
/// it is as large as the prior.
Prior priorOf(const mechanism::Robot& robot, const std::vector<Column>& columns, const Eigen::VectorXd& force_rms_N);

}  // namespace knee_robot::identification
