#pragma once

// The arm of test/dynamics/chain.urdf and what it records along motions that excite all joints.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "knee_robot/dynamics/chain_regressor.h"
#include "knee_robot/mechanism/robot.h"
#include "knee_robot/recording/recording.h"
#include "test/temporary_folder.h"

namespace knee_robot::identification {

inline mechanism::Robot testArm(const std::string& more = "", const std::string& tip = "tool") {
  const TemporaryFolder folder;
  std::ofstream(folder / "robot.yaml")
      << "mechanism: chain\nurdf: " << std::filesystem::absolute(KNEE_SOURCE_DIR "/test/dynamics/chain.urdf").string()
      << "\nbase_link: base\ntip_link: " << tip << "\n"
      << more;
  return mechanism::loadAnyRobot((folder / "robot.yaml").string());
}

/// Torque (N m, N) that a joint's gear takes in addition: joint, time, position, velocity, load without friction.
using GearLoss = std::function<double(int, double, double, double, double)>;

inline constexpr double kViscous = 0.5, kDry = 0.8;
inline const mechanism::Vector3 kPayloadAt(0.05, -0.08, 0.12);  ///< m, last body's frame

/// A recording with friction. `speed`: of the usual one, about 0.3 rad/s; the recording lasts longer. `payload_kg`: a
/// point mass at the last body.
inline recording::Recording armRecording(const mechanism::Robot& robot, int seed, double speed = 1.0,
                                         const GearLoss& loss = nullptr, double payload_kg = 0.0) {
  recording::Recording r;
  r.path = r.name = "arm_" + std::to_string(seed);
  r.fingerprint = std::to_string(seed);
  r.axes = robot.axes();
  const int rows = 3000;
  r.position_m.resize(rows, r.axes);
  r.force_N.resize(rows, r.axes);
  dynamics::ChainRegressorData data(*robot.chain);
  Eigen::VectorXd parameters = dynamics::chainInertia(robot);
  parameters.tail<dynamics::kLinkParameters>() +=
      dynamics::toParameters(dynamics::LinkInertia{payload_kg, kPayloadAt, mechanism::Matrix3::Zero()});
  Eigen::VectorXd q(r.axes), v(r.axes), a(r.axes);
  for (int k = 0; k < rows; ++k) {
    const double t = 0.01 * k;
    r.time_s.push_back(t / speed);
    for (int i = 0; i < r.axes; ++i) {
      q[i] = v[i] = a[i] = 0.0;
      for (int h = 1; h <= 4; ++h) {
        const double w = 2.0 * M_PI * 0.1 * h, phase = 1.7 * i + 2.3 * h + seed;
        const double size = (robot.actuators[static_cast<std::size_t>(i)].revolute ? 0.6 : 0.1) / h;
        q[i] += size * std::sin(w * t + phase);
        v[i] += size * w * speed * std::cos(w * t + phase);
        a[i] -= size * w * w * speed * speed * std::sin(w * t + phase);
      }
    }
    dynamics::chainRegressor(*robot.chain, robot.gravity, q, v, a, data);
    const Eigen::VectorXd load = data.regressor * parameters;
    r.position_m.row(k) = q.transpose();
    for (int i = 0; i < r.axes; ++i) {
      r.force_N(k, i) = load[i] + kViscous * v[i] + kDry * std::tanh(v[i] / (0.005 * speed)) +
                        (loss ? loss(i, t, q[i], v[i], load[i]) : 0.0);
    }
  }
  for (const mechanism::Actuator& joint : robot.actuators) {
    r.position_unit.push_back(mechanism::positionUnit(joint));
    r.force_unit.push_back(mechanism::forceUnit(joint));
  }
  return r;
}

}  // namespace knee_robot::identification
