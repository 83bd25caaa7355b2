#pragma once

// The same kind of states for every engine that scripts/benchmark_peers times: see src/nodes/benchmark_main.cpp.
#include <vector>

#include "test/dynamics/random_robots.h"

namespace knee_robot::dynamics {

inline constexpr std::size_t kPeerStates = 256;

inline std::vector<mechanism::Motion> peerMotions(const mechanism::Mechanism& mechanism) {
  mechanism::RandomPoses random(1, 60.0);
  std::vector<mechanism::Motion> motions;
  while (motions.size() < kPeerStates) {
    mechanism::Motion m;
    m.pose = mechanism::Pose(random.uniform(-0.1, 0.1), random.uniform(0.55, 0.8), random.uniform(-0.3, 0.3),
                             random.uniform(-0.3, 0.3));
    if (mechanism::conditionNumber(mechanism, m.pose) > 60.0) continue;
    m.pose_velocity = random.vector(0.3);
    m.pose_acceleration = random.vector(1.0);
    motions.push_back(m);
  }
  return motions;
}

}  // namespace knee_robot::dynamics
