#include "loaded_start.h"

#include <algorithm>
#include <cmath>

namespace knee_robot::identification {
namespace {

constexpr double kStill_m = 1e-5;     ///< m, rad: less, or a count's rounding, is no movement
constexpr double kLeast_s = 0.2;      ///< of rest
constexpr double kFilterReach = 0.5;  ///< of the low-pass, in periods of the cut-off
constexpr double kLeastFriction_N = 1e-3;

/// Samples before the actuator leaves where it was.
int stillSamples(const Observation& o, Eigen::Index actuator) {
  const auto position = o.signals.position_m.col(actuator);
  const double still_m = std::max(kStill_m, o.sliding[static_cast<std::size_t>(actuator)].resolution);
  int n = 0;
  while (n < o.samples() && std::abs(position[n] - position[0]) < still_m)
    ++n;
  return n;
}

}  // namespace

void findLoadedStart(const std::vector<Column>& columns, const Eigen::VectorXd& parameters, double cutoff_hz,
                     std::vector<Observation>& training) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Eigen::Index column = static_cast<Eigen::Index>(c);
    if (columns[c].role != ColumnRole::Coulomb || parameters[column] < kLeastFriction_N) continue;
    const int i = columns[c].actuator;
    for (Observation& o : training) {
      // What follows within the low-pass' reach is in the filtered force already.
      const int still = stillSamples(o, i) - static_cast<int>(kFilterReach / (cutoff_hz * o.signals.period_s));
      if (still < kLeast_s / o.signals.period_s) continue;
      const Eigen::MatrixXd& own = o.regressor[static_cast<std::size_t>(i)];
      const auto rows = Eigen::seq(0, still - 1);
      const Eigen::VectorXd others = own(rows, Eigen::all) * parameters - own(rows, c) * parameters[column];
      const double load_N = (o.force_filtered_N(rows, i) - others).mean();
      o.sliding[static_cast<std::size_t>(i)].loaded_at_start =
          std::clamp(load_N / (columns[c].newtons * parameters[column]), -1.0, 1.0);
    }
  }
}

void forgetLoadedStart(std::vector<Observation>& training) {
  for (Observation& o : training) {
    for (SlidingPath& path : o.sliding)
      path.loaded_at_start.reset();
  }
}

}  // namespace knee_robot::identification
