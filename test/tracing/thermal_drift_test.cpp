// One motion twice, by a drive that was cold the first time and warm the second: what differs between the two is no
// noise. And a brisk motion beside a slow one: what warms the drive up?
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "knee_robot/dynamics/warming.h"
#include "knee_robot/tracing/trace.h"
#include "test/identification/synthetic.h"

namespace knee_robot::tracing {
namespace {

constexpr double kWarmingSeconds = 40.0, kTimeConstant_s = 15.0, kLost_N = 8.0;
constexpr double kViscousPerDry_s_per_m = 200.0 / 30.0;  // of the synthetic bench
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

/// A brisk and a slow motion of a drive that loses friction as it warms up, by one heat or another, less and less where
/// it levels off.
std::vector<recording::Recording> briskAndSlow(const mechanism::Robot& robot, dynamics::Heat by,
                                               double levels_off = 0.0) {
  std::vector<recording::Recording> out;
  for (const int variant : {0, -4}) {
    recording::Recording r = warmed(robot, variant, 0.0, 5);
    r.name += "_" + std::to_string(variant);
    double share = 0.0, warm = 0.0;
    for (int k = 1; k < r.rows(); ++k) {
      const double way = r.position_m(k, kActuator) - r.position_m(k - 1, kActuator);
      share = std::clamp(share + way / 2e-5, -1.0, 1.0);
      const double speed = std::abs(way) / 0.01;
      const double heat = by == dynamics::Heat::Work ? speed / 0.03 : 1.0;
      const double pace = by == dynamics::Heat::Worked ? speed * (1.0 + kViscousPerDry_s_per_m * speed) / 0.02 : 1.0;
      warm += (heat - warm) * pace * 0.01 / kTimeConstant_s;
      r.force_N(k, kActuator) += kLost_N * (1.0 - (1.0 + levels_off) * warm / (1.0 + levels_off * warm)) * share;
    }
    out.push_back(r);
  }
  return out;
}

TraceResult traceOf(const mechanism::Robot& robot, const std::vector<recording::Recording>& recordings) {
  TraceOptions options;
  options.surrogates = 5;
  options.maps = options.fast_band = false;  // they take time, and find nothing here
  std::vector<identification::Observation> observed;
  for (const recording::Recording& r : recordings)
    observed.push_back(identification::observe(robot, identification::columnsOf(robot), r, options.observation));
  return trace(robot, recordings, observed, options);
}

double heatedBy(const TraceResult& found) {
  EXPECT_EQ(found.effects.size(), 1u);
  if (found.effects.empty()) return -1.0;
  EXPECT_EQ(found.effects[0].hypothesis.place.candidate->name(), "thermal_drift");
  EXPECT_EQ(found.effects[0].hypothesis.place.actuator, kActuator);
  EXPECT_NEAR(found.effects[0].hypothesis.shape[0], kTimeConstant_s, 1.0);
  return found.effects[0].hypothesis.shape[1];
}

TEST(ThermalDrift, IsSaidToFollowTheWorkWhereABriskMotionWarmsMoreThanASlowOne) {
  const mechanism::Robot robot = identification::syntheticBench(2);
  EXPECT_EQ(heatedBy(traceOf(robot, briskAndSlow(robot, dynamics::Heat::Work))),
            dynamics::numberOf(dynamics::Heat::Work));
}

TEST(ThermalDrift, LevelsOffWhereALubricantGetsThinnerLessAndLess) {
  const mechanism::Robot robot = identification::syntheticBench(2);
  constexpr double kLevelsOff = 1.0;  // at the heat of 30 mm/s, that of the recordings: 2/3 at that of 20 mm/s
  const TraceResult found = traceOf(robot, briskAndSlow(robot, dynamics::Heat::Work, kLevelsOff));
  EXPECT_EQ(heatedBy(found), dynamics::numberOf(dynamics::Heat::Work));
  ASSERT_EQ(found.effects.size(), 1u);
  EXPECT_NEAR(found.effects[0].hypothesis.shape[3], kLevelsOff * 2.0 / 3.0, 0.15);
  EXPECT_NEAR(found.effects[0].coefficients[0], -(1.0 + kLevelsOff) * kLost_N * 2.0 / 3.0, 1.5) << "N at little warmth";
}

TEST(ThermalDrift, DoesNotLevelOffWhereItIsInProportion) {
  const mechanism::Robot robot = identification::syntheticBench(2);
  const TraceResult found = traceOf(robot, briskAndSlow(robot, dynamics::Heat::Work));
  ASSERT_EQ(found.effects.size(), 1u);
  EXPECT_EQ(found.effects[0].hypothesis.shape[3], 0.0);
}

TEST(ThermalDrift, IsSaidToFallOffWithTheWorkSoFarAndNotToCoolWhereItDoes) {
  const mechanism::Robot robot = identification::syntheticBench(2);
  const TraceResult found = traceOf(robot, briskAndSlow(robot, dynamics::Heat::Worked));
  EXPECT_EQ(heatedBy(found), dynamics::numberOf(dynamics::Heat::Worked));
  ASSERT_EQ(found.effects.size(), 1u);
  EXPECT_NEAR(found.effects[0].hypothesis.shape[2], kViscousPerDry_s_per_m, 1.5) << "viscous friction heats, too";
  const auto said = std::find_if(found.notes.begin(), found.notes.end(),
                                 [](const std::string& note) { return note.rfind("What warms", 0) == 0; });
  ASSERT_NE(said, found.notes.end());
  EXPECT_NE(said->find("the work of friction so far"), std::string::npos) << *said;
}

TEST(ThermalDrift, IsSaidToFollowTheClockWhereBothWarmAlike) {
  const mechanism::Robot robot = identification::syntheticBench(2);
  EXPECT_EQ(heatedBy(traceOf(robot, briskAndSlow(robot, dynamics::Heat::Clock))),
            dynamics::numberOf(dynamics::Heat::Clock));
}

TEST(ThermalDrift, IsFoundWhereOneOfTwoRepeatsBeganWarm) {
  const mechanism::Robot robot = identification::syntheticRobot();
  const TraceResult found = traceOf(robot, {warmed(robot, 0, 1.0, 1), warmed(robot, 0, 0.0, 2)});

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
