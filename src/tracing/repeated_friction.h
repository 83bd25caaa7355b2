#pragma once

#include <Eigen/Core>

namespace knee_robot::tracing {

/// Takes out of the difference between two runs of one motion what a slowly changing difference of their friction
/// explains: a machine that was warm in one of them is no noise. Per actuator dry and viscous friction, each piecewise
/// linear in time; taken out where pieces of time that were held back gain by two standard errors.
/// `difference`: samples x actuators, low-passed, N. `share` of dry friction, `velocity`: of one of the runs,
/// low-passed alike.
/// Returns the rms per actuator of what was taken out, N.
Eigen::VectorXd takeOutFrictionOfRuns(const Eigen::MatrixXd& share, const Eigen::MatrixXd& velocity,
                                      Eigen::MatrixXd& difference);

}  // namespace knee_robot::tracing
