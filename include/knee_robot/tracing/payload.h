#pragma once

#include <string>

#include "knee_robot/tracing/base_fit.h"

namespace knee_robot::tracing {

/// Whether what the base parameters have taken up looks like a mass on the platform, judged against the robot's own
/// inertia (its URDF). The base model alone cannot tell: a payload is a change of its parameters.
struct PayloadTest {
  bool tested = false;     ///< the robot has a URDF and a body that can carry
  bool is_effect = false;  ///< against a given model of a chain: counted among the effects
  bool stated = false;     ///< the data separate it
  double mass_kg = 0.0, mass_std_kg = 0.0;
  mechanism::Vector3 center_m = mechanism::Vector3::Zero();      ///< in the platform frame, of what can be told
  mechanism::Vector3 center_std_m = mechanism::Vector3::Zero();  ///< large: not told
  double prior_rms =
      0.0;  ///< residual of the URDF's inertia with friction, rotors and offsets fitted, in units of the noise
  double payload_rms = 0.0;  ///< the same with a point mass on the platform fitted as well
  double free_rms = 0.0;     ///< the same of the freely fitted base parameters
  std::string sentence;
};

/// Fits friction, rotors, offsets and the four parameters of a point mass that are linear (mass and first moments;
/// iterated with the moments of inertia that belong to them) on top of the URDF's inertia to the training recordings,
/// weighted by `noise_N` per actuator. Standard errors by leaving blocks out in turn. Stated when the mass is positive,
/// larger than five standard errors and a fiftieth of the platform's own mass, and removes 99 % of the squares by which
/// the URDF alone misses the free fit, or half of them and leaves no more than a quarter more rms than the free fit
/// does.
PayloadTest testPayload(const mechanism::Robot& robot, const std::vector<identification::Observation>& recordings,
                        const Stack& stack, const BaseFit& base, const Eigen::VectorXd& noise_N);

}  // namespace knee_robot::tracing
