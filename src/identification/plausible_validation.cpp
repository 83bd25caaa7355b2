#include "knee_robot/identification/plausible_validation.h"

#include <algorithm>
#include <cmath>

#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"
#include "other_forces.h"
#include "refusals.h"

namespace knee_robot::identification {
namespace {

// Of the force's rms, or of the predicted one's.
constexpr double kHardlyFits = 0.5;
constexpr double kFitsScaled = 0.3;
constexpr double kOtherScale = 2.5;  ///< a drive that gives so much more or less than in training is no drive's error

/// A recorded force beside the predicted one: what is left of it as it is, and of the predicted one when it is
/// multiplied by the factor that fits best.
struct Beside {
  double left = 0.0, factor = 1.0, left_scaled = 1.0;

  bool isScaled() const {
    const bool other = factor < 0.0 || std::max(factor, 1.0 / factor) > kOtherScale;
    return left > kHardlyFits && other && left_scaled < kFitsScaled;
  }
};

Beside beside(const Observation& o, const Prediction& p, int actuator) {
  double measured = 0.0, predicted = 0.0, both = 0.0, left = 0.0;
  for (int n = 0; n < o.samples(); ++n) {
    if (!o.isJudged(n)) continue;
    const double f = o.force_filtered_N(n, actuator), g = p.force_filtered_N(n, actuator);
    measured += f * f;
    predicted += g * g;
    both += f * g;
    left += (f - g) * (f - g);
  }
  Beside out;
  if (measured <= 0.0 || predicted <= 0.0) return out;
  out.left = std::sqrt(left / measured);
  out.factor = both / measured;
  out.left_scaled = std::sqrt(std::max(0.0, 1.0 - both * both / (measured * predicted)));
  return out;
}

std::string percent(double share) {
  return shortNumber(std::round(100.0 * share), 9) + " %";
}

std::string doubtAbout(const mechanism::Robot& robot, const Observation& o, const Prediction& p,
                       const Accuracy& trained) {
  std::vector<int> scaled, bad;
  std::vector<Beside> all;
  for (int i = 0; i < o.axes(); ++i) {
    all.push_back(beside(o, p, i));
    if (all.back().isScaled()) scaled.push_back(i);
    if (all.back().left > kHardlyFits && 0.01 * trained.rms_percent[i] < 0.5 * kHardlyFits) bad.push_back(i);
  }
  const auto of = [&](int i) -> const Beside& { return all[static_cast<std::size_t>(i)]; };
  const auto leaves = [&](int i) { return percent(of(i).left) + " at " + whoIs(robot, i); };
  if (!scaled.empty()) {
    const auto would = [&](int i) {
      return shortNumber(of(i).factor, 2) + " times that force, " + percent(of(i).left_scaled);
    };
    return o.path + ": of its force the model leaves " + joined(scaled, leaves) + "; of " + joined(scaled, would) +
           ": is the sign or the unit of the force another one than in training?";
  }
  if (bad.size() < 2) return "";
  return o.path + ": of its forces the model leaves " + joined(bad, leaves) + ", of those of training " +
         joined(bad, [&](int i) { return percent(0.01 * trained.rms_percent[i]); }) +
         ": is it of this machine, with columns of the same units, signs and order?";
}

}  // namespace

std::vector<std::string> doubtsAboutValidation(const mechanism::Robot& robot,
                                               const std::vector<Observation>& observations,
                                               const std::vector<Prediction>& predictions, const Accuracy& trained) {
  std::vector<std::string> doubts;
  for (std::size_t r = 0; r < observations.size(); ++r) {
    const std::string doubt = doubtAbout(robot, observations[r], predictions[r], trained);
    if (!doubt.empty()) doubts.push_back(doubt);
  }
  return doubts;
}

void requireForces(const mechanism::Robot& robot, const std::vector<Observation>& validation,
                   const ObservationOptions& options) {
  refuseForceless(robot, validation, options);
}

}  // namespace knee_robot::identification
