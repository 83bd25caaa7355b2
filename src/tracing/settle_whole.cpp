#include "settle_whole.h"

#include <algorithm>
#include <set>

#include "refit.h"

namespace knee_robot::tracing {
namespace {

/// What a trial may change of a search.
struct Kept {
  std::vector<FoundEffect> effects;
  std::vector<EffectInput> inputs;
  Eigen::VectorXd seen_parameters, rms_N;
  JointFit fit;
};

Kept keep(const Search& s) {
  return {s.effects, s.data->inputs, s.seen_parameters, s.rms_N, s.fit};
}

void restore(Search& s, Kept kept) {
  s.effects = std::move(kept.effects);
  s.data->inputs = std::move(kept.inputs);
  s.seen_parameters = std::move(kept.seen_parameters);
  s.rms_N = std::move(kept.rms_N);
  s.fit = std::move(kept.fit);
}

void settle(Search& s, Trial& t) {
  Kept kept = keep(s);
  FoundEffect e;
  e.hypothesis = t.hypothesis;
  s.effects.push_back(e);
  refit(s);
  const Eigen::VectorXd left_N = s.rms_N;
  s.rms_N = kept.rms_N;  // both weighted alike
  t.fit = fitOf(s, hypothesesOf(s.effects));
  t.joint_gain = kept.fit.held_back - t.fit.held_back;
  t.nested_gain = t.gain = t.joint_gain;
  t.held = heldBackGain(t.joint_gain);
  t.by_joint = true;
  t.share = (1.0 - left_N.cwiseQuotient(kept.rms_N).array().square()).sum();
  restore(s, std::move(kept));
}

}  // namespace

bool settleWhole(Search& s, std::vector<Trial>& trials) {
  std::set<const Candidate*> tried;
  for (Trial& t : trials) {
    if (isWhole(t.hypothesis) && tried.insert(t.hypothesis.place.candidate).second) settle(s, t);
  }
  return !tried.empty();
}

}  // namespace knee_robot::tracing
