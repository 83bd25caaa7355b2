// A spastic muscle: pulls, late, when it is stretched faster than it bears.
#include "src/tracing/effects/common/line_effect.h"
#include "src/tracing/near_rest.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

constexpr double kDelay_s = 0.06, kDecay_s = 0.6, kStretch_m = 0.005;

class StretchReflex : public SearchedMachine {
 protected:
  std::vector<double> muscle(double threshold_m_per_s) const {
    return {-0.3, 0.1, 0.1, 0.05, 0.9, threshold_m_per_s, kDelay_s, kDecay_s, kStretch_m};
  }
  const Candidate& reflex() const { return *named("stretch_reflex", {}).place.candidate; }
  Line line() const { return lineBetween(data_.inputs.front(), {{-0.3, 0.1, 0.9}, {0.1, 0.05, 0.0}}); }
  /// Share of the muscle's pull that acts, between 0 and 1.
  Eigen::VectorXd activation(double threshold_m_per_s) const {
    const Eigen::MatrixXd pull = reflex().columns(data_.inputs.front(), kActuator, muscle(threshold_m_per_s));
    return pull.col(0).cwiseQuotient(line().lever.col(kActuator));
  }
};

TEST_F(StretchReflex, IsCalledByFastLengtheningAloneAndLate) {
  const double fastest = line().rate_m_per_s.maxCoeff();
  ASSERT_GT(fastest, 0.02);
  EXPECT_TRUE(activation(1.01 * fastest).isZero(1e-12)) << "a slow motion does not call it";
  const Eigen::VectorXd a = activation(0.5 * fastest), rate = line().rate_m_per_s;
  EXPECT_GE(a.minCoeff(), -1e-12);
  EXPECT_LT(a.maxCoeff(), 1.0);
  Eigen::Index fast = 0, called = 0;
  while (rate[fast] <= 0.5 * fastest)
    ++fast;
  while (a[called] <= 1e-9)
    ++called;
  EXPECT_NEAR(static_cast<double>(called - fast) * line().period_s, kDelay_s, 2.0 * line().period_s);
}

TEST_F(StretchReflex, LetsGoWithItsTime) {
  const double fastest = line().rate_m_per_s.maxCoeff();
  const Eigen::VectorXd a = activation(0.5 * fastest);
  Eigen::Index peak = 0;
  a.maxCoeff(&peak);
  Eigen::Index n = peak;
  while (n + 1 < a.size() && a[n + 1] < a[n] && a[n] > 0.6 * a[peak])
    ++n;
  const double waited_s = static_cast<double>(n - peak) * line().period_s;
  ASSERT_GT(waited_s, 0.1);
  EXPECT_GE(a[n], 0.95 * a[peak] * std::exp(-waited_s / kDecay_s)) << "what is left of it decays no faster";
}

TEST_F(StretchReflex, ExplainsACatchWhichADamperWithAValveDoesNot) {
  const double fastest = line().rate_m_per_s.maxCoeff();
  const Hypothesis hidden = named("stretch_reflex", muscle(0.4 * fastest));
  add(effectRows(data_, hidden) * Eigen::VectorXd::Constant(1, 40.0));
  const Projection projection = projectModel(search_, {});
  const double own = explained(data_, hidden, projection, search_.rms_N);
  double damper = 0.0;
  const Candidate& valve = *named("asymmetric_dashpot", {}).place.candidate;
  for (const std::vector<double>& shape : valve.shapes(data_.inputs.front(), -1))
    damper = std::max(damper, explained(data_, named("asymmetric_dashpot", shape), projection, search_.rms_N));
  EXPECT_GT(own, 1.5 * damper);
}

}  // namespace
}  // namespace knee_robot::tracing
