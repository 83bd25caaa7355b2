#include "yielding.h"

#include <cmath>

namespace knee_robot::tracing {

Eigen::VectorXd yieldedShare(const Eigen::VectorXd& way, double over) {
  Eigen::VectorXd out(way.size());
  double now = 0.0;
  for (Eigen::Index n = 0; n < out.size(); ++n) {
    const double to = way[n] > 0.0 ? 1.0 : -1.0;
    out[n] = now = to + (now - to) * std::exp(-std::abs(way[n]) / over);
  }
  return out;
}

}  // namespace knee_robot::tracing
