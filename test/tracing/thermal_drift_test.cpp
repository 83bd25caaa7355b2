// One motion twice, by a drive that was cold the first time and warm the second: what differs between the two is no
// noise.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "knee_robot/tracing/trace.h"
#include "test/identification/synthetic.h"

namespace knee_robot::tracing {
namespace {

constexpr double kWarmingSeconds = 40.0, kTimeConstant_s = 15.0, kLost_N = 8.0;
constexpr int kActuator = 1;

/// `cold` of the friction that warming takes is there at the start: 1 cold, 0 warm already.
recording::Recording warmed(const mechanism::Robot& robot, int variant, double cold, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.3);
  recording::Recording r = identification::syntheticRecording(robot, identification::syntheticModel(robot), variant,
                                                              kWarmingSeconds, [&] { return noise(random); });
  r.name += "_" + std::to_string(seed);
  double share = 0.0;  // a stop of 20 um
  for (int k = 1; k < r.rows(); ++k) {
    share = std::clamp(share + (r.position_m(k, kActuator) - r.position_m(k - 1, kActuator)) / 2e-5, -1.0, 1.0);
    const double left = cold * std::exp(-r.time_s[static_cast<std::size_t>(k)] / kTimeConstant_s);
    r.force_N(k, kActuator) += kLost_N * (left - 1.0) * share;
  }
  return r;
}

TEST(ThermalDrift, IsFoundWhereOneOfTwoRepeatsBeganWarm) {
  const mechanism::Robot robot = identification::syntheticRobot();
  TraceOptions options;
  options.surrogates = 5;
  options.maps = options.fast_band = false;  // they take time, and find nothing here
  const std::vector<recording::Recording> both = {warmed(robot, 0, 1.0, 1), warmed(robot, 0, 0.0, 2)};
  std::vector<identification::Observation> observed;
  for (const recording::Recording& r : both)
    observed.push_back(identification::observe(robot, identification::columnsOf(robot), r, options.observation));
  const TraceResult found = trace(robot, both, observed, options);

  EXPECT_LT(found.floor_N[kActuator], 1.0);
  ASSERT_EQ(found.effects.size(), 1u);
  const FoundEffect& drift = found.effects[0];
  EXPECT_EQ(drift.hypothesis.place.candidate->name(), "thermal_drift");
  EXPECT_EQ(drift.hypothesis.place.actuator, kActuator);
  ASSERT_EQ(drift.coefficients.size(), 4);
  EXPECT_NEAR(drift.hypothesis.shape[0], kTimeConstant_s, 8.0);
  EXPECT_NEAR(drift.coefficients[0], -kLost_N / 2.0, 1.0) << "the mean of one that changes and one that does not";
  EXPECT_NEAR(drift.coefficients[2], -kLost_N / 2.0, 1.0) << "what the second had less at its start";
  const Eigen::VectorXd elsewhere = drift.hypothesis.place.candidate->elsewhere(drift.coefficients);
  EXPECT_EQ(elsewhere.tail(2).norm(), 0.0);
  EXPECT_EQ(elsewhere[0], drift.coefficients[0]);
}

}  // namespace
}  // namespace knee_robot::tracing
