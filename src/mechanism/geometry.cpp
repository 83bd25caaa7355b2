#include "knee_robot/mechanism/geometry.h"

#include <cmath>

namespace knee_robot::mechanism {
namespace {

Vector3 onCircle(double radius, double angle) {
  return {radius * std::cos(angle), radius * std::sin(angle), 0.0};
}

}  // namespace

Mechanism::Mechanism(const Geometry& g) : geometry(g) {
  base_points = {Vector3(-g.R[0], 0.0, 0.0), onCircle(g.R[1], g.beta_FD), onCircle(g.R[2], -g.beta_FI),
                 Vector3(g.ds, 0.0, 0.0)};
  platform_points = {Vector3(-g.Rm[0], 0.0, 0.0), onCircle(g.Rm[1], g.beta_MD), onCircle(g.Rm[2], -g.beta_MI),
                     Vector3::Zero()};
}

}  // namespace knee_robot::mechanism
