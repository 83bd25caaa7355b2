#include "loaded_start.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace knee_robot::identification {
namespace {

constexpr double kFilterReach = 0.5;  ///< of the low-pass, in periods of the cut-off
constexpr double kLeastFriction_N = 1e-3;
constexpr double kLeastStart = 0.05;  ///< of Coulomb friction: less is not worth saying
constexpr double kLeastMemory = 0.2;  ///< of a law's shares: with less it hardly remembers

/// Samples before the actuator leaves where it was.
int stillSamples(const Observation& o, Eigen::Index actuator) {
  const auto position = o.signals.position_m.col(actuator);
  const double still_m = std::max(SlidingPath::kStill, o.sliding[static_cast<std::size_t>(actuator)].resolution);
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
      if (still < SlidingPath::kStands_s / o.signals.period_s) continue;
      const Eigen::MatrixXd& own = o.regressor[static_cast<std::size_t>(i)];
      const auto rows = Eigen::seq(0, still - 1);
      const Eigen::VectorXd others = own(rows, Eigen::all) * parameters - own(rows, c) * parameters[column];
      const double load_N = (o.force_filtered_N(rows, i) - others).mean();
      o.sliding[static_cast<std::size_t>(i)].loaded_at_start =
          std::clamp(load_N / (columns[c].newtons * parameters[column]), -1.0, 1.0);
    }
  }
}

std::vector<double> usualStart(const std::vector<Observation>& training) {
  std::vector<double> usual(training.empty() ? 0 : training.front().sliding.size(), 0.0);
  for (std::size_t i = 0; i < usual.size(); ++i) {
    std::vector<double> starts;
    for (const Observation& o : training) {
      if (o.sliding[i].loaded_at_start) starts.push_back(*o.sliding[i].loaded_at_start);
    }
    if (starts.size() < 2) continue;
    const double count = static_cast<double>(starts.size());
    const double sum = std::accumulate(starts.begin(), starts.end(), 0.0);
    const bool agree = std::all_of(starts.begin(), starts.end(), [&](double start) {
      return std::abs(start - (sum - start) / (count - 1.0)) < std::abs(start);
    });
    if (agree && std::abs(sum) > kLeastStart * count) usual[i] = sum / (count + 1.0);
  }
  return usual;
}

double ofThoseThatRemember(const dynamics::FrictionLaw& law, double share) {
  double remember = 0.0;
  for (int k = 0; k < law.count; ++k) {
    const dynamics::FrictionElement& e = law.elements[static_cast<std::size_t>(k)];
    if (e.kind != dynamics::FrictionKind::Smooth) remember += e.share;
  }
  return remember > kLeastMemory ? std::clamp(share / remember, -1.0, 1.0) : 0.0;
}

void forgetLoadedStart(std::vector<Observation>& training) {
  for (Observation& o : training) {
    for (SlidingPath& path : o.sliding)
      path.loaded_at_start.reset();
  }
}

}  // namespace knee_robot::identification
