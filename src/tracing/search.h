#pragma once

#include <functional>

#include "floor.h"
#include "knee_robot/tracing/trace_result.h"
#include "library.h"
#include "null.h"

namespace knee_robot::tracing {

/// The state of the search: what is in the model, and how well it fits.
struct Search {
  TraceData* data = nullptr;
  BaseFit* base = nullptr;
  Library* library = nullptr;  ///< columns of everything that may be added
  /// What other laws of friction near rest would change: rows in N, not scaled. Nothing is found that they explain as
  /// well.
  Eigen::MatrixXd near_rest;
  Attention attention = Attention::All;
  bool maps = true;                          ///< unnamed ones compete too
  std::vector<Surrogate> surrogates;         ///< with the effects found so far
  std::function<void()> rebuild_surrogates;  ///< after the model has changed; sets the floor too
  const TraceOptions* options = nullptr;
  NoiseFloor floor;
  std::vector<Place>
      absorbed;  ///< the baseline's own columns do the same: such an effect and they would take any value together
  std::vector<FoundEffect> effects;
  JointFit fit;
  Eigen::VectorXd seen_parameters;     ///< of the baseline, that loads and friction in the effects' columns rest on
  Eigen::VectorXd rms_N;               ///< per actuator, of fit
  std::vector<std::string> rejected;   ///< why the search ended
  std::vector<std::string> taken_out;  ///< what was found and did not stay
};

/// The residual of some actuator is more than its noise floor allows: there is something to be explained.
bool exceedsFloor(const Search& search);

/// Adds what the library holds, named effects and maps in the same pass, one after the other while they pass every
/// test; the same effect on other actuators follows at once. At most `most` additions, those not counted.
void searchForward(Search& search, int most, std::uint64_t seed);

/// "stribeck on actuator 2".
std::string placeText(const Place& place);

}  // namespace knee_robot::tracing
