#include "settle_rest_law.h"

#include <algorithm>

#include "effects/common/rest_law.h"
#include "refine.h"
#include "refit.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

constexpr double kLawErrors = 0.5;  ///< standard errors by which a law of its own must be better
constexpr double kUsual_m_per_s = 1e-3;
const double kSpeeds_m_per_s[] = {3.5e-4, 5e-4, 7e-4, 1e-3, 1.4e-3, 2e-3, 2.8e-3};

bool hasRestLaw(const Candidate* kind) {
  const std::vector<ShapeParameter> shape = kind->shapeParameters();
  return !shape.empty() && shape.back().name == restLawParameter().name;
}

void setSpeed(Search& s, const Candidate* kind, double speed_m_per_s) {
  for (FoundEffect& e : s.effects) {
    if (e.hypothesis.place.candidate == kind) e.hypothesis.shape.back() = speed_m_per_s;
  }
}

bool isPlausible(const Search& s, const Candidate* kind, double speed_m_per_s) {
  return std::all_of(s.effects.begin(), s.effects.end(), [&](const FoundEffect& e) {
    std::vector<double> shape = e.hypothesis.shape;
    if (e.hypothesis.place.candidate != kind) return true;
    shape.back() = speed_m_per_s;
    return kind->plausibleShape(shape);
  });
}

/// Held-back squares over all samples alike, weighted with `noise_N`.
Eigen::VectorXd heldBack(const Search& s, const Eigen::VectorXd& noise_N) {
  const std::vector<Hypothesis> all = hypothesesOf(s.effects);
  setAttention(*s.data, Attention::All);
  Eigen::VectorXd out = JointProblem(*s.data, *s.base, noise_N, all, effectRows(*s.data, all)).heldBack();
  setAttention(*s.data, s.attention);
  return out;
}

/// Law of the actuators and shapes of the effects, each chosen beside the other.
bool chooseBeside(Search& s) {
  refit(s);
  bool changed = rebase(s);
  refineShapes(s);
  return rebase(s) || changed;
}

}  // namespace

bool settleRestLaw(Search& s, const Candidate* kind) {
  if (!hasRestLaw(kind)) return false;
  const std::vector<FoundEffect> found = s.effects;
  const Eigen::VectorXd noise_N = s.rms_N;
  setSpeed(s, kind, 0.0);
  chooseBeside(s);
  const Eigen::VectorXd followed = heldBack(s, noise_N);
  const std::vector<FoundEffect> following = s.effects;
  const BaseFit base_following = *s.base;
  s.effects = found;
  setSpeed(s, kind, kUsual_m_per_s);
  chooseBeside(s);
  Eigen::VectorXd own;
  double best_speed = kUsual_m_per_s;
  for (const double speed : kSpeeds_m_per_s) {
    if (!isPlausible(s, kind, speed)) continue;
    setSpeed(s, kind, speed);
    const Eigen::VectorXd now = heldBack(s, noise_N);
    if (own.size() > 0 && now.sum() >= own.sum()) continue;
    own = now;
    best_speed = speed;
  }
  bool own_law = own.size() > 0;  // no speed is plausible for what falls off at the end of what is looked for
  if (own_law) {
    const HeldBackGain gain = heldBackGain(followed - own);
    own_law = gain.mean > kLawErrors * gain.error;
  }
  if (!own_law) {
    s.effects = following;
    adoptBase(s, base_following);
    return true;
  }
  setSpeed(s, kind, best_speed);
  refit(s);
  if (best_speed != kUsual_m_per_s) rebase(s);
  return true;
}

}  // namespace knee_robot::tracing
