#pragma once

#include "knee_robot/tracing/trace.h"

namespace knee_robot::tracing {

/// An effect of a model file as predictions and the search take it. Named candidates come from `named`; maps are added
/// to `maps`.
/// `recordings`: that the file was fitted on. InputError, naming `model_path`, when it is unknown or has other numbers.
FoundEffect effectOf(const mechanism::Robot& robot, const dynamics::ModelEffect& effect, int recordings,
                     const std::string& model_path, const CandidateList& named, CandidateList& maps);

/// Adds an effect to those of a model; a further one by the same name on the same actuator gets the next order.
void addEffect(std::vector<FoundEffect>& effects, FoundEffect effect);

/// Values of a model's parameters in the order of the columns.
Eigen::VectorXd inColumns(const dynamics::Model& model, const std::vector<double>& values,
                          const std::vector<identification::Column>& columns);

}  // namespace knee_robot::tracing
