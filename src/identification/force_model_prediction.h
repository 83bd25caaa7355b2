#pragma once

#include "knee_robot/identification/prediction.h"

namespace knee_robot::identification {

/// predictForces by the force model that the controller has too: parallel robot and bench axes.
PredictedForce predictByForceModel(const dynamics::Model& model, const mechanism::Robot& robot,
                                   const recording::Signals& signals, const MotionPath& motion);

}  // namespace knee_robot::identification
