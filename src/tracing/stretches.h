#pragma once

#include "knee_robot/tracing/hypothesis.h"

namespace knee_robot::tracing {

/// Number of held-back stretches of positions.
inline constexpr int kStretches = 6;

/// Positions of all actuators at the picks.
Eigen::MatrixXd positionsOf(const std::vector<identification::Observation>& recordings, const Stack& stack);
/// Numbers the picks' blocks in equal shares by a coordinate.
void labelBy(const Eigen::VectorXd& along, Stack& stack);
/// The same by where the robot was, along one principal direction of the actuators' positions.
void labelByPosition(const std::vector<identification::Observation>& recordings, int direction, Stack& stack);

}  // namespace knee_robot::tracing
