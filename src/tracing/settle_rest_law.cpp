#include "settle_rest_law.h"

#include <algorithm>

#include "effects/common/rest_law.h"
#include "refine.h"
#include "refit.h"
#include "selection.h"

namespace knee_robot::tracing {
namespace {

constexpr double kLawErrors = 2.0;  ///< standard errors by which a law of its own must be better
constexpr int kMostPasses = 4;      ///< of laws and effects, each beside the other
constexpr double kSettled = 0.04;   ///< of what is left
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

/// Law of the actuators and shapes of the effects, each chosen beside the other, until neither leaves less: friction that
/// multiplies a law which was chosen without it is in part in that law, and each pass takes a part of that part out.
void chooseBeside(Search& s) {
  refit(s);
  rebase(s);
  refineShapes(s);
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const Eigen::VectorXd before_N = s.rms_N;
    rebase(s);
    if ((before_N - s.rms_N).norm() < kSettled * before_N.norm()) break;
  }
}

/// Gives these effects the best smooth law of their own. Returns what that leaves of held-back rows; empty where no speed
/// is plausible, as for what falls off at the end of what is looked for: then the effects are as they were.
Eigen::VectorXd chooseOwnLaw(Search& s, const Candidate* kind, const Eigen::VectorXd& noise_N) {
  const std::vector<FoundEffect> found = s.effects;
  setSpeed(s, kind, kUsual_m_per_s);
  chooseBeside(s);
  Eigen::VectorXd own;
  double best_speed = kUsual_m_per_s;
  for (const double speed : kSpeeds_m_per_s) {
    if (!isPlausible(s, kind, speed)) continue;
    setSpeed(s, kind, speed);
    const Eigen::VectorXd now = heldBackInAll(s, noise_N);
    if (own.size() > 0 && now.sum() >= own.sum()) continue;
    own = now;
    best_speed = speed;
  }
  if (own.size() == 0) {
    s.effects = found;
    return own;
  }
  setSpeed(s, kind, best_speed);
  refit(s);
  if (best_speed != kUsual_m_per_s) rebase(s);
  return own;
}

}  // namespace

bool settleRestLaw(Search& s, const Candidate* kind) {
  if (!hasRestLaw(kind)) return false;
  const Eigen::VectorXd noise_N = s.rms_N;
  const Eigen::VectorXd own = chooseOwnLaw(s, kind, noise_N);
  const std::vector<FoundEffect> with_own = s.effects;
  const BaseFit base_with_own = *s.base;
  // From there, because beside friction that does not multiply it the actuator's law is chosen without a part of that.
  setSpeed(s, kind, 0.0);
  chooseBeside(s);
  if (own.size() == 0) return true;
  const HeldBackGain gain = heldBackGain(heldBackInAll(s, noise_N) - own);
  if (gain.mean > kLawErrors * gain.error) {
    s.effects = with_own;
    adoptBase(s, base_with_own);
  }
  return true;
}

}  // namespace knee_robot::tracing
