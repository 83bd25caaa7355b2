#include "settle_laws.h"

#include "refit.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

constexpr double kBaselineLawErrors = 2.0;  ///< standard errors by which the baseline's law must be better

BaseFit withLaw(const BaseFit& base, const BaseFit& baseline, std::size_t actuator) {
  BaseFit out = base;
  out.friction_laws[actuator] = baseline.friction_laws[actuator];
  out.choices[actuator] = baseline.choices[actuator];
  return out;
}

}  // namespace

bool settleLaws(Search& s, const BaseFit& baseline) {
  if (s.effects.empty()) return false;
  const Attention own = s.attention;
  s.attention = Attention::All;
  setAttention(*s.data, s.attention);
  const Eigen::VectorXd noise_N = s.rms_N;
  Eigen::VectorXd left = heldBackInAll(s, noise_N);
  bool changed = false;
  for (std::size_t i = 0; i < baseline.friction_laws.size(); ++i) {
    if (s.base->friction_laws[i] == baseline.friction_laws[i]) continue;
    const BaseFit now = *s.base;
    adoptBase(s, withLaw(now, baseline, i));
    const Eigen::VectorXd with = heldBackInAll(s, noise_N);
    const HeldBackGain gain = heldBackGain(left - with);
    if (gain.mean > kBaselineLawErrors * gain.error) {
      left = with;
      changed = true;
    } else {
      adoptBase(s, now);
    }
  }
  s.attention = own;
  setAttention(*s.data, own);
  return changed;
}

}  // namespace knee_robot::tracing
