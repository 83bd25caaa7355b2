#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "test/tracing/traced_bench.h"

namespace knee_robot::tracing {
namespace {

constexpr double kLead_m = 0.031, kBalls_m = 0.0185;  // no orders of each other

/// Two bench axes; the first ripples with the screw's turn and with the balls of its nut.
recording::Recording recorded(int variant) {
  std::mt19937 random(static_cast<unsigned>(variant));
  std::normal_distribution<double> noise(0.0, 0.5);
  recording::Recording r = identification::syntheticRecording(bench(), identification::syntheticModel(bench()), variant,
                                                              30.0, [&] { return noise(random); });
  r.fingerprint = "run" + std::to_string(variant);
  for (int k = 0; k < r.rows(); ++k) {
    const double turn = 2.0 * M_PI * r.position_m(k, 0);
    r.force_N(k, 0) += 6.0 * std::sin(turn / kLead_m) + 4.0 * std::cos(turn / kBalls_m);
  }
  r.reference_m = r.position_m;
  return r;
}

const TracedBench& first() {
  static const TracedBench once = tracedBench(recorded(0), nullptr);
  return once;
}

TEST(TwoPeriods, OfOneActuatorAreTwoRipplesByOneName) {
  std::vector<double> periods;
  for (const FoundEffect& e : first().result.effects) {
    EXPECT_EQ(e.hypothesis.place.candidate->name(), "screw_ripple");
    EXPECT_EQ(e.hypothesis.place.actuator, 0);
    periods.push_back(e.hypothesis.shape[0]);
  }
  ASSERT_EQ(periods.size(), 2u);
  std::sort(periods.begin(), periods.end());
  EXPECT_NEAR(periods[0], kBalls_m, 0.01 * kBalls_m);
  EXPECT_NEAR(periods[1], kLead_m, 0.01 * kLead_m);
}

TEST(TwoPeriods, AreBothInTheModelFileAndStillHoldInAnotherRecording) {
  ASSERT_EQ(first().model.effects.size(), 2u);
  const TracedBench again = tracedBench(recorded(1), &first().model);
  ASSERT_EQ(again.result.given.effects.size(), 2u);
  for (const GivenEffect& e : again.result.given.effects)
    EXPECT_TRUE(e.kept) << e.verdict;
  EXPECT_EQ(again.result.effects.size(), 2u) << "nothing is found a second time";
}

TEST(TwoPeriods, OfAModelFileAreBothPredicted) {
  identification::ObservationOptions options;
  options.setCutoff(first().model.cutoff_hz);
  identification::Observation o =
      identification::observe(bench(), identification::columnsOf(bench()), recorded(0), options);
  const Eigen::MatrixXd with = predictModel(bench(), first().model, "model.yaml", o);
  dynamics::Model baseline = first().model;
  baseline.effects.pop_back();
  if (baseline.elsewhere && !baseline.elsewhere->effects.empty()) baseline.elsewhere->effects.pop_back();
  const Eigen::MatrixXd one_only = predictModel(bench(), baseline, "model.yaml", o);
  const auto rms = [&](const Eigen::MatrixXd& predicted) {
    return identification::accuracyOf({o}, {identification::makePrediction(o, predicted, first().model.cutoff_hz)})
        .rms_N[0];
  };
  std::cout << "one ripple " << rms(one_only) << " N, both " << rms(with) << " N\n";
  EXPECT_LT(rms(with), 0.7 * rms(one_only)) << "forces are not low-passed here";
}

}  // namespace
}  // namespace knee_robot::tracing
