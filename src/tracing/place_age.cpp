#include "place_age.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace knee_robot::tracing {
namespace {

constexpr double kPlace_m = 0.001;
constexpr double kStays = 0.6;       ///< places from the middle of one
constexpr double kMostPlaces = 1e5;  ///< of a stroke of 100 m; a longer one is nonsense, but must not fill the memory

}  // namespace

Eigen::VectorXd placeAge(const Eigen::VectorXd& position_m, double period_s) {
  Eigen::VectorXd age(position_m.size());
  if (age.size() == 0) return age;
  const double low_m = position_m.minCoeff(), range_m = position_m.maxCoeff() - low_m;
  const double place_m = std::max(kPlace_m, range_m / kMostPlaces);
  const auto placeAt = [&](Eigen::Index n) { return static_cast<std::size_t>((position_m[n] - low_m) / place_m); };
  const auto isStillAt = [&](std::size_t place, Eigen::Index n) {  // noise on the border of two places is no visit
    return std::abs((position_m[n] - low_m) / place_m - static_cast<double>(place) - 0.5) < kStays;
  };
  const std::size_t places = static_cast<std::size_t>(range_m / place_m) + 1;
  std::vector<double> left_s(places, -std::numeric_limits<double>::infinity());
  std::size_t here = placeAt(0);
  age[0] = kOldest_s;
  for (Eigen::Index n = 1; n < age.size(); ++n) {
    const double now_s = static_cast<double>(n) * period_s;
    const std::size_t next = isStillAt(here, n) ? here : placeAt(n);
    age[n] = next == here ? age[n - 1] : std::min(kOldest_s, now_s - left_s[next]);
    for (; here != next; here < next ? ++here : --here)
      left_s[here] = now_s;  // a fast axis passes several between two samples
  }
  return age;
}

}  // namespace knee_robot::tracing
