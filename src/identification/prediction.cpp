#include "knee_robot/identification/prediction.h"

#include "knee_robot/base/errors.h"
#include "knee_robot/identification/motion_model.h"
#include "knee_robot/identification/observation.h"
#include "knee_robot/recording/signals.h"

namespace knee_robot::identification {

PredictedForce predictForces(const dynamics::Model& model, const mechanism::Robot& robot, const recording::Signals& s,
                             const MotionPath& path) {
  if (!model.effects.empty())
    throw InputError("the model has an effect (" + model.effects.front().name + "); predict it along the recording");
  return motionModelOf(robot)->predict(model, s, path);
}

Eigen::MatrixXd predictForce(const dynamics::Model& model, const mechanism::Robot& robot, const recording::Signals& s,
                             const MotionPath& path) {
  return predictForces(model, robot, s, path).at_sample_N;
}

Prediction makePrediction(const Observation& o, const PredictedForce& force, double cutoff_hz) {
  Prediction prediction = makePrediction(o, force.mean_N, cutoff_hz);
  prediction.row_force_N = recording::atHoldIntervals(o.signals, force.at_sample_N, o.row_time_s);
  return prediction;
}

}  // namespace knee_robot::identification
