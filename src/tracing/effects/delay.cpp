#include <algorithm>
#include <cmath>

#include "knee_robot/recording/filter.h"
#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {
namespace {

constexpr double kLeastPeriods = 0.1;  ///< a shorter delay is a derivative

/// The signal so many samples later, in a straight line between samples.
Eigen::VectorXd later(const Eigen::VectorXd& signal, double samples) {
  Eigen::VectorXd out(signal.size());
  const double last = static_cast<double>(signal.size() - 1);
  for (Eigen::Index n = 0; n < signal.size(); ++n) {
    const double at = std::min(last, static_cast<double>(n) + samples), before = std::floor(at);
    const Eigen::Index k = static_cast<Eigen::Index>(before), next = std::min(k + 1, signal.size() - 1);
    out[n] = signal[k] + (at - before) * (signal[next] - signal[k]);
  }
  return out;
}

/// Of the whole delay, not to first order: the force that the motion needs so much later, less what it needs now.
class Delay : public Candidate {
 public:
  std::string name() const override { return "delay"; }
  bool actsFast() const override { return true; }
  bool leads() const override { return true; }
  std::string sentence() const override {
    return "The force acts later than its command: the command runs ahead of what the motion needs.";
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override { return {{"delay_s", true}}; }
  Eigen::MatrixXd columns(const EffectInput& input, int actuator, const std::vector<double>&) const override {
    const Eigen::VectorXd needed_N = input.needed_N.col(actuator);
    const double ahead_s = input.ahead_s[actuator], period_s = input.signals().period_s;
    if (!(ahead_s > kLeastPeriods * period_s)) return recording::firstDerivative(needed_N, period_s);
    return (later(needed_N, ahead_s / period_s) - needed_N) / ahead_s;
  }
};

}  // namespace

std::unique_ptr<Candidate> makeDelay() {
  return std::make_unique<Delay>();
}

}  // namespace knee_robot::tracing
