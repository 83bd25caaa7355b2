#include "knee_robot/dynamics/pseudo_inertia.h"

namespace knee_robot::dynamics {

mechanism::Matrix4 pseudoInertia(const LinkParameters& p) {
  const double half_trace = 0.5 * (p[0] + p[3] + p[5]);  // integral of |r|^2 dm
  mechanism::Matrix4 j;
  j << half_trace - p[0], -p[1], -p[2], p[6],  //
      -p[1], half_trace - p[3], -p[4], p[7],   //
      -p[2], -p[4], half_trace - p[5], p[8],   //
      p[6], p[7], p[8], p[9];
  return j;
}

LinkParameters parametersOfPseudoInertia(const mechanism::Matrix4& j) {
  LinkParameters p;
  p << j(1, 1) + j(2, 2), -j(0, 1), -j(0, 2), j(0, 0) + j(2, 2), -j(1, 2), j(0, 0) + j(1, 1), j(0, 3), j(1, 3), j(2, 3),
      j(3, 3);
  return p;
}

}  // namespace knee_robot::dynamics
