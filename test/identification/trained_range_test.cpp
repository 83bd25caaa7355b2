#include "knee_robot/identification/trained_range.h"

#include <gtest/gtest.h>

#include "knee_robot/identification/prediction.h"
#include "test/identification/synthetic.h"

namespace knee_robot::identification {
namespace {

Observation observed() {
  const mechanism::Robot robot = syntheticRobot();
  return observe(robot, columnsOf(robot), syntheticRecording(robot, syntheticModel(robot), 0, 12.0), {});
}

TEST(TrainedRange, IsThatOfTheUsableSamplesLowPassed) {
  Observation o = observed();
  o.force_filtered_N(o.samples() / 2, 1) = 1e4;
  o.usable[static_cast<std::size_t>(o.samples() / 2)] = 0;
  const std::vector<dynamics::TrainedForce> range = trainedRange({o});
  ASSERT_EQ(range.size(), 4u);
  EXPECT_LT(range[1].high_N, 1e4) << "a masked sample is no training";
  for (int n = 0; n < o.samples(); ++n) {
    if (!o.usable[static_cast<std::size_t>(n)]) continue;
    EXPECT_GE(o.force_filtered_N(n, 1), range[1].low_N);
    EXPECT_LE(o.force_filtered_N(n, 1), range[1].high_N);
  }
}

TEST(TrainedRange, BoundsPredictionsWhereThePoseIsMaskedAndNowhereElse) {
  const mechanism::Robot robot = syntheticRobot();
  Observation o = observed();
  dynamics::Model model = syntheticModel(robot);
  const Eigen::MatrixXd free = predictForces(model, robot, o.signals, o.motion).mean_N;
  const double low = free.col(0).minCoeff(), high = free.col(0).maxCoeff(), third = (high - low) / 3.0;
  model.trained_force_N.assign(4, {-1e9, 1e9});
  model.trained_force_N[0] = {low + third, high - third};
  EXPECT_EQ(predictForces(model, robot, o.signals, o.motion).mean_N, free) << "no pose is uncertain";
  const int half = o.samples() / 2;
  std::fill(o.motion.uncertain.begin() + half, o.motion.uncertain.end(), 1);
  const Eigen::MatrixXd bound = predictForces(model, robot, o.signals, o.motion).mean_N;
  EXPECT_EQ(bound.topRows(half), free.topRows(half));
  EXPECT_EQ(bound.rightCols(3), free.rightCols(3));
  const double margin = kBeyondTrained * third;
  EXPECT_NEAR(bound.col(0).tail(o.samples() - half).maxCoeff(), high - third + margin, 1e-9);
  EXPECT_NEAR(bound.col(0).tail(o.samples() - half).minCoeff(), low + third - margin, 1e-9);
}

}  // namespace
}  // namespace knee_robot::identification
