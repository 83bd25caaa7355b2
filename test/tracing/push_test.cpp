#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

constexpr double kPushedSeconds = 30.0, kFrom_s = 12.0, kDuration_s = 4.0;

TEST(Push, IsNotLookedForInTheFirstHalfSecondUnlessItIsLong) {
  const mechanism::Robot robot = simulatedRobot();
  const std::vector<identification::Column> columns = identification::columnsOf(robot);
  const identification::Observation observed = identification::observe(
      robot, columns, simulatedRecording(robot, 1, kPushedSeconds, ""), TraceOptions().observation);
  EffectInput input;
  input.robot = &robot;
  input.observation = &observed;
  int pushes = 0, early = 0;
  for (const auto& candidate : namedCandidates(robot)) {
    if (candidate->name() != "external_force") continue;
    for (const std::vector<double>& shape : candidate->shapes(input, -1)) {
      ++pushes;
      std::vector<std::vector<double>> all = candidate->near(shape, 1.0);
      all.push_back(shape);
      for (const std::vector<double>& one : all)
        early += one[1] < 0.5 && one[1] + one[2] < 2.0 ? 1 : 0;
    }
  }
  EXPECT_GT(pushes, 50);
  EXPECT_EQ(early, 0) << "friction has what nobody recorded in its memory there";
}

TEST(Trace, FindsAStrongPushAndKeepsItOutOfWhatItPredictsElsewhere) {
  const mechanism::Robot robot = simulatedRobot();
  TraceOptions options;
  options.surrogates = 5;
  const std::vector<identification::Column> columns = identification::columnsOf(robot);
  const recording::Recording quiet = simulatedRecording(robot, 1, kPushedSeconds, "");
  const double start = quiet.time_s.front() + kFrom_s;
  const recording::Recording pushed = simulatedRecording(
      robot, 1, kPushedSeconds,
      "  - {name: external_force, start_s: " + std::to_string(start) +
          ", end_s: " + std::to_string(start + kDuration_s) + ", force_N: [0, 0, -60], point_m: [0.1, 0, 0]}\n");
  identification::Observation other =
      identification::observe(robot, columns, simulatedRecording(robot, 2, kPushedSeconds, ""), options.observation);
  const auto errorOf = [&](const Eigen::MatrixXd& force_N) {
    return identification::accuracyOf({other},
                                      {identification::makePrediction(other, force_N, options.observation.cutoff_hz)})
        .rms_N;
  };

  const TraceResult found =
      trace(robot, {pushed}, {identification::observe(robot, columns, pushed, options.observation)}, options);
  options.most_effects = 0;
  const TraceResult clean =
      trace(robot, {quiet}, {identification::observe(robot, columns, quiet, options.observation)}, options);

  ASSERT_EQ(found.effects.size(), 1u);
  const FoundEffect& push = found.effects[0];
  EXPECT_EQ(push.hypothesis.place.candidate->name(), "external_force");
  EXPECT_NEAR(push.hypothesis.shape[1], kFrom_s, 1.0);
  EXPECT_NEAR(push.hypothesis.shape[2], kDuration_s, 1.5);
  const Eigen::VectorXd before_N = errorOf(predictBaseline(found, other));
  const Eigen::VectorXd after_N = errorOf(predictTraced(robot, found, other, -1, 1));
  const Eigen::VectorXd clean_N = errorOf(predictBaseline(clean, other));
  EXPECT_LT(before_N.norm(), 1.05 * clean_N.norm()) << "the baseline is identify's, whose loss hardly hears a push";
  EXPECT_LT(after_N.norm(), 1.05 * clean_N.norm());
}

}  // namespace
}  // namespace knee_robot::tracing
