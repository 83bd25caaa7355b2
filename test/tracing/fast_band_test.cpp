#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "knee_robot/tracing/trace.h"
#include "test/identification/synthetic.h"

namespace knee_robot::tracing {
namespace {

/// A bench axis of 60 kg at 100 Hz whose motion has a part at 5 Hz; its commands run ahead of what the motion needs.
recording::Recording recorded(double ahead_s) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 1.0);
  recording::Recording r;
  r.name = r.path = "axis.csv";
  r.axes = 1;
  const int rows = 5000;
  r.position_m.resize(rows, 1);
  r.force_N.resize(rows, 1);
  const double hz[] = {0.13, 0.31, 0.7, 5.0}, speed[] = {0.05, 0.04, 0.03, 0.01};
  const auto motion = [&](double t) {
    Eigen::Vector3d x(0.3, 0.0, 0.0);
    for (int h = 0; h < 4; ++h) {
      const double w = 2.0 * M_PI * hz[h], phase = w * t + h;
      x += speed[h] * Eigen::Vector3d(std::sin(phase) / w, std::cos(phase), -w * std::sin(phase));
    }
    return x;
  };
  for (int k = 0; k < rows; ++k) {
    const double t = 0.01 * k;
    r.time_s.push_back(t);
    r.position_m(k, 0) = 2e-6 * std::round(motion(t)[0] / 2e-6);
    const Eigen::Vector3d at = motion(t + 0.005 + ahead_s);  // a row's force holds for the 10 ms after it
    r.force_N(k, 0) = 60.0 * at[2] + 300.0 * at[1] + 20.0 * std::tanh(at[1] / 1e-3) + noise(random);
  }
  r.reference_m = r.position_m;
  return r;
}

TraceResult traced(double ahead_s, bool fast_band) {
  const mechanism::Robot robot = identification::syntheticBench(1);
  const recording::Recording recording = recorded(ahead_s);
  TraceOptions options;
  options.surrogates = 3;
  options.fast_band = fast_band;
  return trace(robot, {recording},
               {identification::observe(robot, identification::columnsOf(robot), recording, options.observation)},
               options);
}

TEST(FastBand, FindsNothingInACleanRecording) {
  EXPECT_TRUE(traced(0, true).effects.empty());
}

TEST(FastBand, FindsADelayThatSlowForcesHardlyShow) {
  const TraceResult slow = traced(0.003, false), both = traced(0.003, true);
  std::printf("3 Hz alone: %zu effects; with the band above: %zu\n", slow.effects.size(), both.effects.size());
  EXPECT_TRUE(slow.effects.empty());
  ASSERT_EQ(both.effects.size(), 1u);
  const FoundEffect& found = both.effects.front();
  EXPECT_EQ(found.hypothesis.place.actuator, 0);
  const std::string name = found.hypothesis.place.candidate->name();
  EXPECT_TRUE(name == "delay" || name == "drive_lag") << name;  // the same to first order
  EXPECT_GT(found.band_hz, 8.0);
  EXPECT_NEAR(found.coefficients[0], 0.003, 0.0015);
}

}  // namespace
}  // namespace knee_robot::tracing
