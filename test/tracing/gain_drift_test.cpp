// A motor that weakens as its windings warm up.
#include <algorithm>
#include <cmath>

#include "knee_robot/dynamics/warming.h"
#include "test/tracing/searched_machine.h"

namespace knee_robot::tracing {
namespace {

TEST(GainDrift, OfWindingsFollowsTheSquareOfTheForceWithItsTimeConstant) {
  constexpr int kSamples = 4000;
  constexpr double kPeriod_s = 0.01, kForce_N = 50.0, kUsual_N = 100.0, kConstant_s = 15.0;
  const mechanism::Robot robot = identification::syntheticRobot();
  identification::Observation observation;
  observation.signals.period_s = kPeriod_s;
  for (int n = 0; n < kSamples; ++n)
    observation.signals.time_s.push_back(kPeriod_s * n);
  observation.signals.velocity_m_per_s = Eigen::MatrixXd::Zero(kSamples, robot.axes());
  observation.signals.position_m = observation.signals.force_N = observation.signals.velocity_m_per_s;
  EffectInput input;
  input.robot = &robot;
  input.observation = &observation;
  input.force_N = Eigen::MatrixXd::Constant(kSamples, robot.axes(), kForce_N);
  const CandidateList all = namedCandidates(robot);
  const auto drift = std::find_if(all.begin(), all.end(), [](const auto& c) { return c->name() == "gain_drift"; });
  const double by_windings = dynamics::numberOf(dynamics::Heat::Winding);
  const Eigen::VectorXd column = (*drift)->columns(input, 0, {kConstant_s, by_windings, 0.0, kUsual_N}).col(0);
  const double heat = (kForce_N / kUsual_N) * (kForce_N / kUsual_N);
  for (const int n : {0, 1500, kSamples - 1})
    EXPECT_NEAR(column[n], kForce_N * heat * (1.0 - std::exp(-kPeriod_s * n / kConstant_s)), 1e-9);
}

}  // namespace
}  // namespace knee_robot::tracing
