// What the controller feeds forward is part of the command, and the command is the whole force: a recording that was
// made with feedforward identifies the same model as one that was made without.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "knee_robot/identification/identify.h"
#include "knee_robot/identification/prediction.h"
#include "simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

constexpr double kForwardSeconds = 30.0;
const FedForward kNothing{"", 0.0};

identification::Observation observed(const mechanism::Robot& robot, int variant, const FedForward& feedforward) {
  return identification::observe(robot, identification::columnsOf(robot),
                                 simulatedRecording(robot, variant, kForwardSeconds, "", feedforward),
                                 identification::ObservationOptions());
}

dynamics::Model identified(const mechanism::Robot& robot, const FedForward& feedforward) {
  std::vector<identification::Observation> training;
  for (const int variant : {1, 2})
    training.push_back(observed(robot, variant, feedforward));
  return identification::identify(robot, training, {}).model;
}

/// Whether the actuator has been moving, and will be, for as long as the low-pass reaches: at rest and near it the
/// force that holds is the controller's choice.
bool keepsMoving(const identification::Observation& o, int sample, int actuator) {
  constexpr double kReach_s = 0.33;
  const int reach = static_cast<int>(kReach_s / o.signals.period_s);
  for (int n = std::max(0, sample - reach); n <= std::min(o.samples() - 1, sample + reach); ++n) {
    if (!o.axis_moving(n, actuator) || !o.usable[static_cast<std::size_t>(n)]) return false;
  }
  return true;
}

/// Root mean square over all actuators, each where it keeps moving.
double movingRms(const identification::Observation& o, const Eigen::MatrixXd& force_N) {
  double square = 0.0;
  int count = 0;
  for (int n = 0; n < o.samples(); ++n) {
    for (int i = 0; i < o.axes(); ++i) {
      if (!keepsMoving(o, n, i)) continue;
      square += force_N(n, i) * force_N(n, i);
      ++count;
    }
  }
  return std::sqrt(square / count);
}

TEST(RecordingWithFeedforward, IdentifiesTheSameModelAsOneWithout) {
  const mechanism::Robot robot = simulatedRobot();
  const dynamics::Model without = identified(robot, kNothing);
  const std::string path = testing::TempDir() + "feedforward_recording_" + std::to_string(getpid()) + ".yaml";
  dynamics::saveModel(without, path);
  const dynamics::Model with = identified(robot, {path, 1.0});
  std::remove(path.c_str());

  const identification::Observation validation = observed(robot, 3, kNothing);
  const auto predicted = [&](const dynamics::Model& model) {
    const identification::PredictedForce force =
        identification::predictForces(model, robot, validation.signals, validation.motion);
    return identification::makePrediction(validation, force, 3.0).force_filtered_N;
  };
  const double apart = movingRms(validation, predicted(with) - predicted(without));
  const double whole = movingRms(validation, validation.force_filtered_N);
  std::printf("models apart by %.2f of %.1f N rms where the axes keep moving\n", apart, whole);
  EXPECT_LT(apart, 0.01 * whole);
  for (std::size_t k = 0; k < with.parameters.size(); ++k) {
    if (with.parameters[k].name.rfind("F", 0) != 0) continue;  // viscous and Coulomb friction
    EXPECT_NEAR(with.parameters[k].value, without.parameters[k].value, 0.01 * without.parameters[k].value)
        << with.parameters[k].name;
  }
}

}  // namespace
}  // namespace knee_robot::tracing
