#include "reflex.h"

#include <algorithm>

namespace knee_robot::tracing {

Eigen::VectorXd reflexActivation(const Eigen::VectorXd& rate, double period_s, const Reflex& reflex) {
  const double late = reflex.delay_s / period_s, keeps = period_s / reflex.decay_s;
  Eigen::VectorXd activation(rate.size());
  double a = 0.0;
  for (Eigen::Index n = 0; n < rate.size(); ++n) {
    const double seen_at = std::max(0.0, static_cast<double>(n) - late);
    const Eigen::Index before = static_cast<Eigen::Index>(seen_at), after = std::min(before + 1, rate.size() - 1);
    const double part = seen_at - static_cast<double>(before), seen = (1.0 - part) * rate[before] + part * rate[after];
    const double called = std::max(0.0, seen - reflex.threshold_per_s) / reflex.stretch * period_s;
    a = (a + called) / (1.0 + called + keeps);  // implicit: between 0 and 1 whatever the step
    activation[n] = a;
  }
  return activation;
}

}  // namespace knee_robot::tracing
