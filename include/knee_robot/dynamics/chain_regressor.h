#pragma once

#include <Eigen/Core>
#include <vector>

#include "knee_robot/dynamics/parameters.h"
#include "knee_robot/dynamics/rigid_body.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::dynamics {

/// Workspace and result of chainRegressor: make one per chain and keep it.
struct ChainRegressorData {
  explicit ChainRegressorData(const mechanism::Chain& chain)
      : regressor(Eigen::MatrixXd::Zero(chain.size(), chain.size() * kLinkParameters)),
        lever(static_cast<std::size_t>(chain.size())),
        axis(static_cast<std::size_t>(chain.size())) {}

  Eigen::MatrixXd regressor;  ///< joints x 10 per body, order of parameters.h
  std::vector<mechanism::Vector3> lever, axis;
};

/// Regressor of an open chain by Newton and Euler, body by body from the base: joint torques (N m, prismatic: forces in
/// N) = data.regressor * inertial parameters of the bodies, each about its own frame's origin. Gravity (m/s^2, base
/// frame) included, friction not. Positions in rad or m, one entry a joint. Real-time safe.
void chainRegressor(const mechanism::Chain& chain, const mechanism::Vector3& gravity, const Eigen::VectorXd& position,
                    const Eigen::VectorXd& velocity, const Eigen::VectorXd& acceleration, ChainRegressorData& data);

/// Inertial parameters of the chain's bodies by its URDF, ten a body, with what is fixed to a body counted in. A link
/// whose principal moments break the triangle inequality counts as the nearest possible one. InputError that names link
/// and URDF when its inertia is negative or no number.
Eigen::VectorXd chainInertia(const mechanism::Robot& robot);

/// Links whose inertia in the URDF no body can have.
std::vector<std::string> impossibleLinks(const mechanism::Chain& chain);

/// Jacobian (6 x joints: linear, then angular, base frame) of the point `at` (m) in the last body's frame.
Eigen::Matrix<double, 6, Eigen::Dynamic> chainJacobian(const mechanism::Chain& chain, const Eigen::VectorXd& position,
                                                       const mechanism::Vector3& at);

/// "IXX_1" ... "m_1", "IXX_2" ...: ten a body.
std::vector<std::string> chainInertialNames(int joints);

}  // namespace knee_robot::dynamics
