#pragma once

#include "knee_robot/tracing/trace.h"

namespace knee_robot::tracing {

/// How a recording must be observed for a model's predictions: its cut-off and its limit of motion.
identification::ObservationOptions observationOptions(const dynamics::Model& model);

/// Force (N, samples x actuators) that any model file predicts along a recording, from motion and time alone: of
/// identify or of trace, with or without effects. For a file of trace the same as predictTraced of the result that it
/// was written from.
///
/// Order: friction's memory, with its own low-pass, along the whole recording from full rest at its first sample; then
/// loads and friction by `effects_see`; then every effect in the file's order from those loads, each with its own state
/// from the first sample on (presliding: no deflection; thermal drift: cold); once more from the forces with effects;
/// then the parameters and the effects added up. On a recording that the file lists under `data` effects that belong to
/// one recording are put in; on all others they are left out, and the numbers `elsewhere` count where the file has
/// some.
/// InputError, naming `model_path`, when an effect is unknown or its numbers are not that effect's.
Eigen::MatrixXd predictModel(const mechanism::Robot& robot, const dynamics::Model& model, const std::string& model_path,
                             identification::Observation& observation);

/// A model of trace as predictTraced takes it. What only the search knows (evidence, floor, ranks) stays empty.
TraceResult resultOf(const mechanism::Robot& robot, const dynamics::Model& model, const std::string& model_path);

}  // namespace knee_robot::tracing
