#pragma once

#include <Eigen/Geometry>
#include <random>

#include "knee_robot/base/constants.h"
#include "knee_robot/mechanism/kinematics.h"

namespace knee_robot::mechanism {

/// The geometries of the paper's Table 1 and of the sister robot B, as tests need them.
inline Geometry geometryOf(std::array<double, 3> R, double ds, double fd_deg, double fi_deg, std::array<double, 3> Rm,
                           double md_deg, double mi_deg) {
  return {R, ds, fd_deg * kDegree, fi_deg * kDegree, Rm, md_deg * kDegree, mi_deg * kDegree};
}
inline Mechanism finalMechanism() {
  return Mechanism(geometryOf({0.4, 0.4, 0.4}, 0.15, 90, 45, {0.3, 0.3, 0.3}, 50, 90));
}
inline Mechanism startingMechanism() {
  return Mechanism(geometryOf({0.4, 0.4, 0.4}, 0.0, 50, 40, {0.2, 0.2, 0.2}, 40, 30));
}
inline Mechanism mechanismB() {
  return Mechanism(geometryOf({0.5, 0.45, 0.45}, 0.15, 70, 70, {0.3, 0.3, 0.3}, 10, 10));
}

/// Deterministic random poses over the robot's workspace, kept away from singularities by `condition_max`.
class RandomPoses {
 public:
  explicit RandomPoses(unsigned seed, double condition_max = 200.0) : engine_(seed), condition_max_(condition_max) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Vector4 vector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  Pose pose(const Mechanism& mechanism) {
    for (;;) {
      const Pose pose(uniform(-0.15, 0.25), uniform(0.5, 0.85), uniform(-0.5, 0.5), uniform(-0.5, 0.5));
      if (conditionNumber(mechanism, pose) < condition_max_) return pose;
    }
  }

 private:
  std::mt19937 engine_;
  double condition_max_;
};

}  // namespace knee_robot::mechanism
