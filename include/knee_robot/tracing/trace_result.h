#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "knee_robot/tracing/angles.h"
#include "knee_robot/tracing/given_model.h"
#include "knee_robot/tracing/joint_fit.h"
#include "knee_robot/tracing/payload.h"

namespace knee_robot::tracing {

/// Everything that tracing may be told.
struct TraceOptions {
  identification::ObservationOptions observation;
  int rank = 0;                             ///< of the baseline; 0: chosen on the training data
  std::uint64_t seed = 1;                   ///< of surrogates and resampling
  int surrogates = 10;                      ///< surrogates of the recordings, simulated
  int draws = 240;                          ///< of the null distribution, at least
  int most_effects = 6;                     ///< additions; the same effect on several actuators counts once
  bool maps = true;                         ///< unnamed ones are tried as well
  bool fast_band = true;                    ///< a second, higher band is searched for what shows in fast motion only
  std::shared_ptr<const StartModel> start;  ///< null: no model is given
  /// What `identify` fitted to the same observations with the same options: its laws near rest need not be chosen again.
  /// Null: they are chosen.
  std::shared_ptr<const identification::Identification> laws_of;
  std::function<void(const std::string&)> progress = [](const std::string&) {};
};

/// An effect that was added to the model, and what speaks for it. Vectors: per actuator.
struct FoundEffect {
  Hypothesis hypothesis;
  Eigen::VectorXd coefficients, std;
  /// How much the residual's rms falls when it is added, or in the end rises without it, the larger: root of the squares'
  /// difference.
  Eigen::VectorXd explained_rms_N;
  Eigen::VectorXd null_rms_N;  ///< the same for the best hypothesis on the worst of the surrogates
  double p = 1.0;
  double gain = 0.0, gain_error = 0.0;  ///< held-back blocks: share of the squared residual, and its standard error
  std::vector<std::string> indistinguishable_from;
  /// That the name is right and not the rival that comes closest on held-back blocks: normal approximation. What no
  /// candidate describes has no rival here: see probabilityOfName().
  double probability = 1.0;
  bool doubted = false;         ///< so improbable that it is reported as unnamed: what it does is known, not what it is
  double elsewhere_gain = 0.0;  ///< held-back stretches of other positions: share of the squared residual
  double elsewhere_gaining =
      1.0;                ///< share of those stretches that gain, with all samples or while axes move, the less
  bool transfers = true;  ///< false: predicts nothing in other recordings
  double band_hz = 0.0;   ///< cut-off of the second band, when it was found there; 0: in the first

  /// Three names or more that the data do not tell apart are no attribution: reported as unnamed.
  bool isOneOfMany() const { return indistinguishable_from.size() > 2; }
  /// Reported as unnamed, or as a name "or unnamed".
  bool maybeUnnamed() const {
    const std::vector<std::string>& others = indistinguishable_from;
    return doubted || std::find(others.begin(), others.end(), "unnamed") != others.end();
  }
};

/// Share of names that were right on machines of the ten newest simulators by others when it was chosen, each as it
/// came: 82 of 98; 122 of 141 with the next four (docs/results/blind_simulators.md).
inline constexpr double kNamesRight = 0.84;
inline double probabilityOfName(const FoundEffect& e) {
  return kNamesRight * e.probability;
}

/// What tracing learned from training recordings.
struct TraceResult {
  BaseFit baseline;                    ///< without effects
  BaseFit base;                        ///< laws near rest and strength of the prior chosen anew beside the effects
  std::vector<std::int64_t> home_ids;  ///< of the training recordings; 0: not known
  std::shared_ptr<CandidateList> candidates;  ///< that the effects point into
  std::vector<FoundEffect> effects;
  Eigen::VectorXd parameters;                 ///< of the extended model's linear part
  Eigen::VectorXd seen_parameters;            ///< those that effects looked at (loads, friction) when they were fitted
  Eigen::VectorXd floor_N;                    ///< per actuator
  std::string floor_source;                   ///< repeats, or how it was estimated
  Eigen::VectorXd before_rms_N, after_rms_N;  ///< training rows
  std::vector<std::string> absorbed;          ///< what the base parameters take up, one sentence each
  std::string presliding;  ///< where the baseline's laws near rest have it surely, with the laws; empty: nowhere
  std::string stiction;    ///< the same of a peak near rest
  std::vector<std::string> rejected;  ///< what came close, and why it was not added
  std::vector<std::string>
      doubts;  ///< whether the baseline describes the training recordings at all; what recordings are warned of
  std::vector<std::string> notes;
  std::vector<PlaceAngles> angles;  ///< of all named candidates, along the training recordings
  PayloadTest payload;              ///< against the URDF's inertia; its sentence is among `absorbed`
  GivenModel given;                 ///< what of the model that was started from still holds
  /// For other recordings: fitted without effects of which it is not known what they depend on. Empty: this result
  /// itself.
  std::shared_ptr<const TraceResult> elsewhere;
  /// For a controller: fitted without effects that it cannot give instant by instant. Empty: as elsewhere.
  std::shared_ptr<const TraceResult> feedforward;
};

}  // namespace knee_robot::tracing
