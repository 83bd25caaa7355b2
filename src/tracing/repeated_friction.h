#pragma once

#include <Eigen/Core>
#include <vector>

namespace knee_robot::tracing {

/// What columns that were fitted without a block of the rows save in it, in standard errors over the blocks: slow noise
/// saves nothing there.
double surenessOf(const Eigen::MatrixXd& columns, const Eigen::VectorXd& difference);

/// Takes out of the difference between two runs of one motion what a slowly changing difference of their friction
/// explains: a machine that was warm in one of them is no noise. Per actuator dry and viscous friction, each piecewise
/// linear in time; taken out where pieces of time that were held back gain by two standard errors.
/// `difference`: samples x actuators, low-passed, N. `share` of dry friction, `velocity`: of one of the runs,
/// low-passed alike.
/// Returns the rms per actuator of what was taken out, N.
Eigen::VectorXd takeOutFrictionOfRuns(const Eigen::MatrixXd& share, const Eigen::MatrixXd& velocity,
                                      Eigen::MatrixXd& difference);

/// The same of another mass that the platform carried in one of the runs.
/// `carried`: per actuator, its force per unit of the platform's first moments and mass along one of the runs,
/// low-passed. Returns the rms of what was taken out, N: of the actuator with the largest.
double takeOutPayloadOfRuns(const std::vector<Eigen::MatrixXd>& carried, Eigen::MatrixXd& difference);

}  // namespace knee_robot::tracing
