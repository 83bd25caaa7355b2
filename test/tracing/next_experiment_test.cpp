#include "knee_robot/tracing/next_experiment.h"

#include <gtest/gtest.h>

#include "test/identification/synthetic.h"
#include "test/mechanism/configured_robot.h"

namespace knee_robot::tracing {
namespace {

dynamics::Model trueModel(const mechanism::Robot& robot) {
  return identification::syntheticModel(robot);
}

/// A finished trace whose only effect, quadratic drag on actuator 3, could as well be Stribeck friction: the training
/// motion is slow.
struct Case {
  mechanism::Robot robot;
  std::vector<identification::Observation> training;
  TraceResult result;
  TraceOptions options;
};

Case confusable(const mechanism::Robot& robot) {
  Case c{robot, {}, {}, {}};
  const recording::Recording recording = identification::syntheticRecording(robot, trueModel(robot), 1, 20.0);
  c.training.push_back(
      identification::observe(robot, identification::columnsOf(robot), recording, c.options.observation));
  std::vector<identification::Observation> copy = c.training;
  const Stack stack = makeStack(copy, c.options.observation);
  BaseOptions how;
  how.rank = robot.mechanism ? 20 : 0;
  c.result.base = fitBase(robot, copy, stack, identification::columnsOf(robot), how);
  c.result.parameters = c.result.base.parameters;
  c.result.candidates = std::make_shared<CandidateList>(namedCandidates(robot));
  c.result.floor_N = c.result.after_rms_N = Eigen::VectorXd::Ones(robot.axes());
  FoundEffect drag;
  for (const auto& candidate : *c.result.candidates) {
    if (candidate->name() == "quadratic_drag") drag.hypothesis.place.candidate = candidate.get();
  }
  drag.hypothesis.place.actuator = std::min(2, robot.axes() - 1);
  drag.coefficients = Eigen::VectorXd::Constant(1, 2000.0);
  drag.indistinguishable_from = {"stribeck"};
  c.result.effects = {drag};
  return c;
}

NextExperimentOptions quick() {
  NextExperimentOptions options;
  options.duration_s = 20.0;
  options.random = 12;
  options.improving = 12;
  return options;
}

void expectThatTheAngleGrows(const Case& c) {
  const NextExperiment next = planNextExperiment(c.robot, c.result, c.training, c.options, quick());
  ASSERT_TRUE(next.planned) << next.reason;
  EXPECT_GT(next.then.angle_rad, 1.2 * next.now.angle_rad);
  std::printf("angle %.2f -> %.2f deg, visible %.2f -> %.2f N, %d motions\n", 57.3 * next.now.angle_rad,
              57.3 * next.then.angle_rad, next.now.visible_N, next.then.visible_N, next.motions);

  // What is written is what was judged: read back, playable, and with the same angle when it is played.
  const trajectory::Reference read =
      trajectory::parseReference(trajectory::formatReference(next.reference), "next_experiment.txt");
  EXPECT_EQ(read.space, trajectory::Space::Actuator);
  EXPECT_TRUE(trajectory::checkReference(read, c.robot).ok());
  std::vector<identification::Observation> played = {identification::observe(
      c.robot, identification::columnsOf(c.robot), idealRecording(read, c.robot.axes()), c.options.observation)};
  const Candidate* rival = nullptr;
  for (const auto& candidate : *c.result.candidates) {
    if (candidate->name() == "stribeck") rival = candidate.get();
  }
  const Separation again = separationOf(c.robot, c.result, c.result.effects[0], *rival, played, c.options.observation);
  EXPECT_NEAR(again.angle_rad, next.then.angle_rad, 1e-3);
}

TEST(NextExperiment, MakesTheAngleBetweenTwoExplanationsGrowOnTheRobot) {
  expectThatTheAngleGrows(confusable(mechanism::configuredRobot("B")));
}

TEST(NextExperiment, MakesItGrowOnABenchToo) {
  mechanism::Robot bench = identification::syntheticBench(2);
  for (mechanism::Actuator& a : bench.actuators) {
    a.position_min_m = 0.0;
    a.position_max_m = 0.4;
    a.velocity_max_m_per_s = 0.3;
    a.acceleration_max_m_per_s2 = 5.0;
  }
  expectThatTheAngleGrows(confusable(bench));
}

TEST(NextExperiment, IsNotPlannedWithoutAPairOrForWhatDoesNotTransfer) {
  Case c = confusable(mechanism::configuredRobot("B"));
  c.result.effects[0].indistinguishable_from = {"external_force"};
  const NextExperiment push = planNextExperiment(c.robot, c.result, c.training, c.options, quick());
  EXPECT_FALSE(push.planned);
  EXPECT_NE(push.reason.find("external_force"), std::string::npos) << push.reason;
  c.result.effects[0].indistinguishable_from.clear();
  const NextExperiment none = planNextExperiment(c.robot, c.result, c.training, c.options, quick());
  EXPECT_FALSE(none.planned);
  EXPECT_TRUE(none.first.empty());
}

}  // namespace
}  // namespace knee_robot::tracing
