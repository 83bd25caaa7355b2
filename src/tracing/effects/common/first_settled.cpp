#include "first_settled.h"

#include <cmath>

namespace knee_robot::tracing {
namespace {

constexpr double kForgotten_m = 3e-4;  ///< that friction's memory takes to be lost: more than most bristles give
constexpr double kMoves_m = 3.0 * kForgotten_m;

}  // namespace

int firstSettled(const EffectInput& input, int actuator) {
  const auto q = input.friction_position_m.col(actuator);
  if (q.maxCoeff() - q.minCoeff() < kMoves_m) return 0;
  int n = 0;
  while (std::abs(q[n] - q[0]) < kForgotten_m)
    ++n;
  return n;
}

}  // namespace knee_robot::tracing
