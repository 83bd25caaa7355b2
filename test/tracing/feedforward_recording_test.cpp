// What the controller foresees is part of the command, and the command is the whole force: a recording that was made with feedforward
// identifies the same model as one that was made without.
#include <gtest/gtest.h>

#include <iostream>

#include "knee_robot/identification/identify.h"
#include "knee_robot/identification/prediction.h"
#include "simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

constexpr double kSeconds = 30.0;

dynamics::Model identified(const mechanism::Robot& robot, const Foreseen& foreseen) {
  std::vector<identification::Observation> training;
  for (const int variant : {1, 2})
    training.push_back(identification::observe(robot, identification::columnsOf(robot),
                                               simulatedRecording(robot, variant, kSeconds, "", foreseen), {}));
  return identification::identify(robot, training, {}).model;
}

double rms(const Eigen::MatrixXd& m) {
  return m.norm() / std::sqrt(static_cast<double>(m.size()));
}

TEST(RecordingWithFeedforward, IdentifiesTheSameModelAsOneWithout) {
  const mechanism::Robot robot = simulatedRobot();
  const dynamics::Model without = identified(robot, {"", 0.0});
  const std::string path = testing::TempDir() + "feedforward_recording_" + std::to_string(getpid()) + ".yaml";
  dynamics::saveModel(without, path);
  const dynamics::Model with = identified(robot, {path, 1.0});
  std::remove(path.c_str());

  const identification::Observation other = identification::observe(
      robot, identification::columnsOf(robot), simulatedRecording(robot, 3, kSeconds, "", {"", 0.0}),
      identification::ObservationOptions());
  const auto predicted = [&](const dynamics::Model& model) {
    return identification::makePrediction(other,
                                          identification::predictForces(model, robot, other.signals, other.motion), 3.0)
        .force_filtered_N;
  };
  const Eigen::MatrixXd by_one = predicted(without), by_other = predicted(with);
  std::cout << rms(by_one - other.force_filtered_N) << " " << rms(by_other - other.force_filtered_N) << " "
            << rms(by_one - by_other) << " " << rms(other.force_filtered_N) << std::endl;
  EXPECT_LT(rms(by_one - by_other), 0.02 * rms(other.force_filtered_N));
  EXPECT_NEAR(rms(by_other - other.force_filtered_N), rms(by_one - other.force_filtered_N),
              0.1 * rms(by_one - other.force_filtered_N));
}

}  // namespace
}  // namespace knee_robot::tracing
