#pragma once

#include <Eigen/Core>

namespace knee_robot::tracing {

/// Share of its force that something which gives and then yields has reached, as by Dahl (1968): -1 to 1, coming up over
/// a way after each reversal, and kept at rest.
/// `way`: gone since the sample before, in the unit of `over`, which is positive. It begins at 0: nobody knows how it came
/// to where a recording begins.
Eigen::VectorXd yieldedShare(const Eigen::VectorXd& way, double over);

}  // namespace knee_robot::tracing
