#pragma once

#include "knee_robot/dynamics/rigid_model.h"
#include "test/mechanism/random_poses.h"

namespace knee_robot::dynamics {

/// A physically consistent inertia without any symmetry: a cloud of point masses.
inline LinkInertia randomLink(mechanism::RandomPoses& random, double mass, double size) {
  LinkInertia link;
  constexpr int kPoints = 6;
  std::array<mechanism::Vector3, kPoints> points;
  std::array<double, kPoints> masses{};
  for (int k = 0; k < kPoints; ++k) {
    points[k] =
        mechanism::Vector3(random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size));
    masses[k] = mass * random.uniform(0.5, 1.5) / kPoints;
    link.mass += masses[k];
    link.center += masses[k] * points[k];
  }
  link.center /= link.mass;
  for (int k = 0; k < kPoints; ++k) {
    const mechanism::Vector3 c = points[k] - link.center;
    link.inertia += masses[k] * (c.squaredNorm() * mechanism::Matrix3::Identity() - c * c.transpose());
  }
  return link;
}

inline RobotInertia randomInertia(mechanism::RandomPoses& random) {
  RobotInertia inertia;
  for (int leg = 0; leg < mechanism::kLegs; ++leg) {
    inertia.links[cylinderLink(leg)] = randomLink(random, 2.5, 0.2);
    inertia.links[rodLink(leg)] = randomLink(random, 0.8, 0.2);
    inertia.rotor_mass[leg] = random.uniform(3.0, 7.0);
  }
  inertia.links[kPlatformLink] = randomLink(random, 9.0, 0.2);
  return inertia;
}

inline mechanism::Motion randomMotion(mechanism::RandomPoses& random, const mechanism::Mechanism& mechanism,
                                      double velocity = 0.5, double acceleration = 2.0) {
  return {random.pose(mechanism), random.vector(velocity), random.vector(acceleration)};
}

constexpr double kConditionMaximum = 200.0;  ///< the stated margin from singularity: condition of dq/dx (m, rad)

inline double relativeError(const mechanism::Vector4& a, const mechanism::Vector4& b) {
  return (a - b).norm() / std::max(1.0, b.norm());
}

}  // namespace knee_robot::dynamics
