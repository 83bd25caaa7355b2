#pragma once

#include "knee_robot/tracing/effect_input.h"

namespace knee_robot::tracing {

/// Two points that something is tied to.
struct Anchors {
  mechanism::Vector3 base_m = mechanism::Vector3::Zero();      ///< base frame
  mechanism::Vector3 platform_m = mechanism::Vector3::Zero();  ///< platform frame
};

/// The straight line between them at one sample.
struct LineBetween {
  double length_m = 0.0, rate_m_per_s = 0.0;
  mechanism::Vector4 force_on_pose =
      mechanism::Vector4::Zero();  ///< generalized force (N, N, N m, N m) that lengthens it, per newton along the line
};
/// `rotation`: of the platform at that sample.
LineBetween lineBetween(const mechanism::Motion& motion, const mechanism::Matrix3& rotation, const Anchors& anchors);

/// Force of one actuator per newton of force that the actuators need to lengthen the line, and the line itself, sample by sample.
struct LineForces {
  Eigen::VectorXd lever, length_m, rate_m_per_s;
};
LineForces lineForces(const EffectInput& input, int actuator, const Anchors& anchors);

/// Shapes of an effect between two points: X and Y of the base point and of the platform point (both at height 0), on a coarse grid
/// that the robot's radii span.
std::vector<std::vector<double>> anchorGrid(const mechanism::Robot& robot);
/// Shapes beside one, `step` of the grid's distance away.
std::vector<std::vector<double>> anchorsNear(const std::vector<double>& shape, double step);
/// Names of those four, for ShapeParameter.
extern const char* const kAnchorNames[4];
Anchors anchorsOf(const std::vector<double>& shape);

}  // namespace knee_robot::tracing
