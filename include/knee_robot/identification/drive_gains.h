#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "knee_robot/identification/observation.h"

namespace knee_robot::identification {

inline constexpr double kGainInterval = 1.96;  ///< standard errors of 95 %

/// Torque per ampere of a chain's drives, from recordings of their currents.
struct DriveGains {
  Eigen::VectorXd gain;  ///< per joint: N m/A (prismatic: N/A)
  Eigen::VectorXd std;   ///< by leaving blocks of the recordings out in turn
  double payload_kg = 0.0;
  mechanism::Vector3 center_m = mechanism::Vector3::Zero();  ///< of the payload, last body's frame
  mechanism::Vector3 center_std_m = mechanism::Vector3::Zero();
  Eigen::VectorXd percent;  ///< per joint: 100 rms(error) / rms(current) of the joint fit
  int iterations = 0;
  std::vector<std::string> notes;  ///< what is doubtful about them, as sentences
};

/// Gains from the same robot without and with a payload of known mass at its last body: inertial parameters, the
/// payload's centre and inertia, friction, rotors, offsets and gains fitted together to the measured currents (errors
/// in the currents, not in the motion), by Gauss and Newton. The payload's mass sets the scale; joints that hardly feel
/// it get theirs through the bodies that they share with the others. Without loaded recordings the URDF's inertia sets
/// the scale. All observed with the gains that `robot` has.
/// Refusal when a joint never moves, a gain comes out negative (a current's wrong sign), the payload is not felt, a
/// gain's interval contains zero, or the mass cannot be the payload's, so that the arm itself would have several times
/// its weight.
DriveGains driveGains(const mechanism::Robot& robot, const std::vector<Observation>& unloaded,
                      const std::vector<Observation>& loaded, double payload_kg, const ObservationOptions& options);

/// The gains that `robot` is given where its file leaves them open: by the URDF's inertia, with standard errors. True
/// when some were.
bool gainsByUrdf(mechanism::Robot& robot, const std::vector<Observation>& training, const ObservationOptions& options);

}  // namespace knee_robot::identification
