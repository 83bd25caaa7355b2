#include "taut_string.h"

#include <algorithm>
#include <limits>

namespace knee_robot::recording {

Eigen::VectorXd tautString(const Eigen::VectorXd& y, double half) {
  const Eigen::Index n = y.size();
  Eigen::VectorXd out = y;
  if (n < 3 || half <= 0.0) return out;
  Eigen::Index from = 0;
  double here = y[0];
  while (from < n - 1) {
    // The funnel of straight lines from here that stay within the band.
    double steepest = std::numeric_limits<double>::infinity(), flattest = -steepest;
    Eigen::Index above = from + 1, below = from + 1, corner = -1;
    double at = 0.0;
    for (Eigen::Index k = from + 1; k < n; ++k) {
      const double way = static_cast<double>(k - from), up = (y[k] + half - here) / way,
                   down = (y[k] - half - here) / way;
      if (down > steepest) {
        corner = above;
        at = y[above] + half;
        break;
      }
      if (up < flattest) {
        corner = below;
        at = y[below] - half;
        break;
      }
      if (up <= steepest) {
        steepest = up;
        above = k;
      }
      if (down >= flattest) {
        flattest = down;
        below = k;
      }
    }
    if (corner < 0) {
      corner = n - 1;
      const double way = static_cast<double>(corner - from);
      at = here + std::clamp((y[corner] - here) / way, flattest, steepest) * way;
    }
    for (Eigen::Index k = from; k <= corner; ++k)
      out[k] = here + (at - here) * static_cast<double>(k - from) / static_cast<double>(corner - from);
    from = corner;
    here = at;
  }
  return out;
}

}  // namespace knee_robot::recording
