#include "absorbed.h"

#include <algorithm>
#include <map>

#include "said_of_laws.h"

namespace knee_robot::tracing {
namespace {

constexpr double kNothingLeft = 0.02;  ///< share of a column's square that the base parameters leave: absorbed
constexpr double kSame = 1e-3;         ///< the same, of a column that is one of the baseline's

}  // namespace

void noteWhatIsAbsorbed(Search& s, const Projection& projection, TraceResult& result) {
  std::map<const Candidate*, double> most;  // of any shape on any actuator
  for (const PlaceColumns& p : s.library->places()) {
    const Candidate* candidate = p.place().candidate;
    if (!candidate->transfers() || candidate->isMap()) continue;
    std::vector<double> survives = makeProbes(*s.data, p.tried, p.rows, p.first_row, projection, s.rms_N).survives;
    std::sort(survives.begin(), survives.end());  // of an effect between two points, some anchors are always told apart
    const double typical = candidate->shared() ? survives[survives.size() / 2] : survives.back();
    most[candidate] = std::max(most[candidate], typical);
    if (!candidate->shared() && survives.back() < kSame) s.absorbed.push_back(p.place());
  }
  for (const auto& candidate : *result.candidates) {
    if (most.count(candidate.get()) > 0 && most[candidate.get()] < kNothingLeft)
      result.absorbed.push_back(candidate->name() +
                                (candidate->shared()
                                     ? ": along these recordings gravity and friction of the baseline take up most "
                                       "of what one between two points would do"
                                     : ": the baseline's constant force and friction of the actuator take it up"));
  }
  result.presliding = longPresliding(result.baseline.choices);
  if (!result.presliding.empty())
    result.absorbed.push_back("presliding: " + result.presliding + "; the baseline's law near rest has it");
  result.stiction = peakNearRest(result.baseline.choices);
  if (!result.stiction.empty())
    result.absorbed.push_back("stiction: " + result.stiction + "; the baseline's law near rest has it");
  result.absorbed.push_back("reflected_inertia: is a parameter of the baseline (rotor)");
  if (!s.data->recordings.front().motion.coupled) return;
  result.absorbed.push_back(result.payload.sentence);
  result.absorbed.push_back("base_tilt: turns gravity, which the fitted first moments and offsets follow");
}

}  // namespace knee_robot::tracing
