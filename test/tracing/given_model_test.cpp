#include "knee_robot/tracing/given_model.h"

#include <gtest/gtest.h>

#include <random>

#include "knee_robot/base/errors.h"
#include "test/tracing/traced_bench.h"

namespace knee_robot::tracing {
namespace {

/// What the bench axes of one recording have beyond rigid motion and friction.
struct Hidden {
  double drag_2 = 0.0;    ///< N s2/m2 on axis 2
  double ripple_1 = 0.0;  ///< N, with a period of 10 mm, on axis 1
};

recording::Recording recorded(int variant, const Hidden& hidden) {
  std::mt19937 random(static_cast<unsigned>(variant));
  std::normal_distribution<double> noise(0.0, 0.5);
  recording::Recording r = identification::syntheticRecording(bench(), identification::syntheticModel(bench()), variant,
                                                              30.0, [&] { return noise(random); });
  r.fingerprint = "run" + std::to_string(variant);
  for (int k = 0; k + 1 < r.rows(); ++k) {
    const double v = (r.position_m(k + 1, 1) - r.position_m(k, 1)) / 0.01;
    r.force_N(k, 1) += hidden.drag_2 * v * std::abs(v);
    r.force_N(k, 0) += hidden.ripple_1 * std::sin(2.0 * M_PI * r.position_m(k, 0) / 0.01);
  }
  r.reference_m = r.position_m;
  return r;
}

bool has(const std::vector<FoundEffect>& effects, const std::string& name, int actuator) {
  return std::any_of(effects.begin(), effects.end(), [&](const FoundEffect& e) {
    return e.hypothesis.place.candidate->name() == name && e.hypothesis.place.actuator == actuator;
  });
}

const dynamics::Model& given() {
  static const dynamics::Model model = tracedBench(recorded(0, {4000.0, 0.0}), nullptr).model;
  return model;
}

TEST(GivenModel, ThatStillHoldsNeedsNothingMore) {
  ASSERT_EQ(given().effects.size(), 1u);
  const TracedBench t = tracedBench(recorded(1, {4000.0, 0.0}), &given());
  ASSERT_EQ(t.result.given.effects.size(), 1u);
  EXPECT_EQ(t.result.given.effects[0].verdict, "still holds");
  EXPECT_TRUE(t.result.given.effects[0].kept);
  ASSERT_EQ(t.result.effects.size(), 1u) << "the effect is kept, nothing is found again";
  EXPECT_TRUE(std::isnan(t.result.effects[0].p)) << "its evidence is another recording's";
  ASSERT_EQ(t.result.given.parameters.size(), 6u) << "viscous, Coulomb, rotor of two axes";
  for (const GivenParameter& p : t.result.given.parameters)
    EXPECT_NEAR(p.now, p.given, std::max(4.0 * p.std, 0.02 * p.given)) << p.name;
}

TEST(GivenModel, IsSearchedForWhatItLacksOnly) {
  const TracedBench t = tracedBench(recorded(1, {4000.0, 12.0}), &given());
  EXPECT_EQ(t.result.effects.size(), 2u);
  EXPECT_TRUE(has(t.result.effects, given().effects[0].name, 1));
  EXPECT_TRUE(has(t.result.effects, "screw_ripple", 0));
}

TEST(GivenModel, LosesAnEffectThatNewRecordingsDoNotHave) {
  const TracedBench t = tracedBench(recorded(1, {0.0, 0.0}), &given());
  ASSERT_EQ(t.result.given.effects.size(), 1u);
  EXPECT_FALSE(t.result.given.effects[0].kept);
  EXPECT_EQ(t.result.given.effects[0].verdict, "is not needed here");
  EXPECT_TRUE(t.result.effects.empty());
}

TEST(GivenModel, SaysThatAnEffectHasChanged) {
  const TracedBench t = tracedBench(recorded(1, {12000.0, 0.0}), &given());
  ASSERT_EQ(t.result.given.effects.size(), 1u);
  EXPECT_EQ(t.result.given.effects[0].verdict, "has changed");
}

TEST(GivenModel, IsCorrectedInTheDirectionsThatTheDataKnow) {
  dynamics::Model start = identification::syntheticModel(identification::syntheticRobot());
  const mechanism::Robot robot = identification::syntheticRobot();
  recording::Recording recording = identification::syntheticRecording(robot, start, 1, 20.0);
  std::vector<identification::Observation> training = {
      identification::observe(robot, identification::columnsOf(robot), recording, {})};
  const Eigen::VectorXd known = startParameters({start, "given.yaml"}, identification::columnsOf(robot));
  BaseOptions how;
  how.given = known;
  const BaseFit base = fitBase(robot, training, makeStack(training, {}), identification::columnsOf(robot), how);
  for (std::size_t c = 0; c < base.columns.size(); ++c) {
    const double value = known[static_cast<Eigen::Index>(c)];
    EXPECT_NEAR(base.parameters[static_cast<Eigen::Index>(c)], value, 0.05 * std::abs(value) + 0.2)
        << base.columns[c].name << ": exact data leave nothing to correct, also where they say nothing";
  }
  start.parameters.front().name = "joint";
  EXPECT_THROW(startParameters({start, "given.yaml"}, identification::columnsOf(robot)), InputError);
}

}  // namespace
}  // namespace knee_robot::tracing
