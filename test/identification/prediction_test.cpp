#include "knee_robot/identification/prediction.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test/identification/synthetic.h"

namespace knee_robot::identification {
namespace {

TEST(Prediction, IsFiniteForEveryRowEvenAcrossGapsJitterAndUnreachableLengths) {
  const mechanism::Robot robot = syntheticRobot();
  const dynamics::Model model = syntheticModel(robot);
  recording::Recording r = syntheticRecording(robot, model, 0, 20.0);
  for (int k = 0; k < r.rows(); ++k)
    r.time_s[k] += (k % 3) * 0.002 + (k > 900 ? 0.3 : 0.0);
  for (int k = 500; k < 520; ++k)
    r.position_m(k, 0) = 3.0;  // no pose has such a leg
  const ObservationOptions options;
  const Observation o = observe(robot, columnsOf(robot), r, options);
  const Prediction p = makePrediction(o, predictForces(model, robot, o.signals, o.motion), options.cutoff_hz);
  ASSERT_EQ(p.row_force_N.rows(), r.rows());
  EXPECT_TRUE(p.row_force_N.allFinite());
  EXPECT_TRUE(p.force_filtered_N.allFinite());
}

TEST(Prediction, DoesNotDependOnTheRecordedForces) {
  const mechanism::Robot robot = syntheticRobot();
  const dynamics::Model model = syntheticModel(robot);
  recording::Recording r = syntheticRecording(robot, model, 1, 10.0);
  const ObservationOptions options;
  const Observation with = observe(robot, columnsOf(robot), r, options);
  r.force_N.setConstant(-7.0);
  const Observation without = observe(robot, columnsOf(robot), r, options);
  EXPECT_EQ(predictForces(model, robot, with.signals, with.motion).mean_N,
            predictForces(model, robot, without.signals, without.motion).mean_N);
}

TEST(Prediction, OfTheTrueModelMatchesEachRowsForce) {
  const mechanism::Robot robot = syntheticRobot();
  const dynamics::Model model = syntheticModel(robot);
  const recording::Recording r = syntheticRecording(robot, model, 0, 30.0);
  ObservationOptions options;
  options.signals.motion_cutoff_hz = 20.0;
  options.motion_cutoff_given = true;
  const Observation o = observe(robot, columnsOf(robot), r, options);
  const Prediction p = makePrediction(o, predictForces(model, robot, o.signals, o.motion), options.cutoff_hz);
  const Eigen::MatrixXd error = (p.row_force_N - r.force_N).cwiseAbs();
  int compared = 0;
  for (int n = 30; n + 30 < o.samples(); ++n) {  // grid sample n is row n here
    if (o.signals.velocity_m_per_s.row(n).cwiseAbs().minCoeff() < 0.005)
      continue;  // the friction step lies between samples
    EXPECT_LT(error.row(n).maxCoeff(), 0.5) << "row " << n;
    ++compared;
  }
  EXPECT_GT(compared, r.rows() / 2);
}

TEST(Accuracy, ComputesTheFiguresOfTheReport) {
  const mechanism::Robot robot = syntheticBench(1);
  const dynamics::Model model = syntheticModel(robot);
  const ObservationOptions options;
  std::vector<Observation> list = {
      observe(robot, columnsOf(robot), syntheticRecording(robot, model, 0, 20.0), options)};
  const Observation& o = list[0];
  const Prediction shifted = makePrediction(o, o.signals.force_N.array() + 3.0, options.cutoff_hz);
  const Accuracy a = accuracyOf(list, {shifted});
  EXPECT_NEAR(a.rms_N[0], 3.0, 1e-9);
  EXPECT_NEAR(a.rms_moving_N[0], 3.0, 1e-9);
  EXPECT_NEAR(a.rms_resting_N[0], 3.0, 1e-9) << "between its movements";
  EXPECT_NEAR(a.rms_since_moved_N[0], 3.0, 1e-9);
  EXPECT_NEAR(a.max_N[0], 3.0, 1e-9);
  EXPECT_NEAR(a.rms_percent[0], 300.0 / std::sqrt(o.force_filtered_N.squaredNorm() / o.samples()), 1e-9);
  EXPECT_NEAR(a.range_percent[0], 300.0 / (o.force_filtered_N.maxCoeff() - o.force_filtered_N.minCoeff()), 1e-9);
  EXPECT_EQ(a.samples, o.samples());
  EXPECT_GT(a.moving_samples, 0);
}

TEST(Accuracy, SaysNothingAboutMovingSamplesWhereThereAreNone) {
  const mechanism::Robot robot = syntheticBench(2);
  const dynamics::Model model = syntheticModel(robot);
  recording::Recording r = syntheticRecording(robot, model, 0, 20.0);
  r.position_m.col(1).setConstant(0.2);
  const ObservationOptions options;
  std::vector<Observation> list = {observe(robot, columnsOf(robot), r, options)};
  const Accuracy a = accuracyOf(list, {makePrediction(list[0], list[0].signals.force_N, options.cutoff_hz)});
  EXPECT_EQ(a.moving_samples, 0);
  EXPECT_TRUE(std::isnan(a.rms_moving_N[0]));
  EXPECT_TRUE(std::isnan(a.rms_resting_N[1])) << "it has not moved yet: nobody knows what it holds";
  EXPECT_TRUE(std::isnan(a.rms_since_moved_N[1]));
  EXPECT_TRUE(std::isfinite(a.rms_since_moved_N[0]));
}

TEST(Accuracy, HasAFigureWithoutTheRestBeforeAnAxisFirstMoves) {
  const mechanism::Robot robot = syntheticBench(2);
  recording::Recording r = syntheticRecording(robot, syntheticModel(robot), 0, 20.0);
  for (Eigen::Index i = 0; i < r.position_m.cols(); ++i)
    r.position_m.col(i).head(r.rows() / 4).setConstant(r.position_m(r.rows() / 4, i));
  const ObservationOptions options;
  std::vector<Observation> list = {observe(robot, columnsOf(robot), r, options)};
  Eigen::MatrixXd predicted = list[0].signals.force_N;
  predicted.topRows(list[0].samples() / 5).array() += 10.0;
  const Accuracy a = accuracyOf(list, {makePrediction(list[0], predicted, options.cutoff_hz)});
  EXPECT_GT(a.rms_N.minCoeff(), 4.0);
  EXPECT_LT(a.rms_since_moved_N.maxCoeff(), 0.05) << "what friction held there is not in the recording";
}

}  // namespace
}  // namespace knee_robot::identification
