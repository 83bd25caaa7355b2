#pragma once

#include <memory>
#include <string>
#include <vector>

#include "knee_robot/dynamics/model.h"
#include "knee_robot/tracing/base_fit.h"

namespace knee_robot::tracing {

/// A model file that tracing starts from.
struct StartModel {
  dynamics::Model model;
  std::string path;
};

/// What new recordings say about one effect of the model that tracing started from.
struct GivenEffect {
  dynamics::ModelEffect effect;  ///< as the file has it
  bool kept = false;             ///< in the new model too, refitted
  std::string verdict;           ///< still holds, has changed, is not needed here, belongs to its own recordings
  std::vector<dynamics::EffectParameter> now;  ///< refitted coefficients; empty: not judged
  double gain = 0.0, gain_error = 0.0;         ///< share of the squared residual of held-back blocks that it saves
};

/// A friction or rotor parameter, in the file and on the new recordings.
struct GivenParameter {
  std::string name, unit;
  double given = 0.0, now = 0.0, std = 0.0;  ///< std: of `now`, by leaving blocks out
};

/// What of a given model still holds.
struct GivenModel {
  std::string path;  ///< empty: none was given
  std::vector<GivenEffect> effects;
  std::vector<GivenParameter> parameters;
};

/// The given model's parameters in the order of `columns`. InputError when it has a parameter that is
/// none of the columns (the joints' own friction).
Eigen::VectorXd startParameters(const StartModel& start, const std::vector<identification::Column>& columns);

}  // namespace knee_robot::tracing
