#include "friction_shared.h"

#include <algorithm>
#include <cmath>

#include "friction_families.h"

namespace knee_robot::identification {
namespace {

using dynamics::FrictionElement;
using dynamics::FrictionKind;

constexpr double kSharedErrors =
    0.5;  ///< a law that actuators share may be so many standard errors worse than one's own

/// A law of the velocity that half of the actuators or more have is another one's, too, unless that one's is better by
/// so many standard errors (of three quarters of them: so many more), or by more than a tenth of what it leaves: few
/// blocks may hold all of the difference.
constexpr double kFamilyErrors = 2.0, kFamilyOfMostErrors = 3.0, kNearBest = 1.1;

}  // namespace

std::vector<dynamics::FrictionLaw> sharedLaws(const std::vector<FrictionChoice>& around) {
  std::vector<dynamics::FrictionLaw> laws;
  for (const FrictionChoice& one : around) {
    laws.push_back(one.law);
    for (const TriedLaw& tried : one.tried) {
      if (tried.law.count == 1 && tried.law.elements.front().smooth != dynamics::SmoothShape::Ramp)
        laws.push_back(tried.law);
    }
  }
  return laws;
}

std::vector<Sum> inElements(const std::vector<dynamics::FrictionLaw>& laws, std::vector<FrictionElement>& elements) {
  std::vector<Sum> sums;
  for (const dynamics::FrictionLaw& law : laws) {
    Sum sum;
    sum.weights.resize(law.count);
    for (int k = 0; k < law.count; ++k) {
      FrictionElement e = law.elements[static_cast<std::size_t>(k)];
      sum.weights[k] = std::abs(e.share);
      e.share = e.share < 0.0 ? -1.0 : 1.0;
      const auto found = std::find(elements.begin(), elements.end(), e);
      sum.which.push_back(static_cast<int>(found - elements.begin()));
      if (found == elements.end()) elements.push_back(e);
    }
    sums.push_back(sum);
  }
  return sums;
}

void shareFamily(std::vector<FrictionChoice>& choices) {
  const long axes = static_cast<long>(choices.size());
  for (const int family : kOfVelocity) {
    const long alike =
        std::count_if(choices.begin(), choices.end(), [&](const FrictionChoice& c) { return c.family == family; });
    if (alike < 2 || 2 * alike < axes) continue;
    const double errors = 4 * alike >= 3 * axes ? kFamilyOfMostErrors : kFamilyErrors;
    for (FrictionChoice& choice : choices) {
      const auto own =
          std::find_if(choice.tried.begin(), choice.tried.end(), [&](const TriedLaw& t) { return t.family == family; });
      if (choice.family == family || own == choice.tried.end()) continue;
      const double best = own->held_back - own->beyond_best;
      if (own->beyond_best > errors * own->standard_error || own->held_back > kNearBest * best) continue;
      choice.law = own->law;
      choice.family = family;
    }
    return;
  }
}

void shareLaw(const std::vector<dynamics::FrictionLaw>& laws, const std::vector<OthersLaws>& others,
              const std::vector<double>& narrowest_m, std::vector<FrictionChoice>& choices) {
  const auto isRareLaw = [](const dynamics::FrictionLaw& law) {
    return std::any_of(law.elements.begin(), law.elements.begin() + law.count, isRare);
  };
  const auto tooNarrow = [&](std::size_t axis, std::size_t law) {
    return std::any_of(laws[law].elements.begin(), laws[law].elements.begin() + laws[law].count,
                       [&](const FrictionElement& e) {
                         return e.kind == FrictionKind::Stop && e.width_m < (1.0 - 1e-9) * narrowest_m[axis];
                       });
  };
  const auto worse = [&](std::size_t axis, std::size_t law, double& error) {
    error = 0.0;
    if (tooNarrow(axis, law) || (isRareLaw(laws[law]) && !isRareLaw(choices[axis].law)))
      return std::numeric_limits<double>::infinity();
    const OthersLaws& o = others[axis];
    const Eigen::ArrayXd difference = o.error.col(static_cast<Eigen::Index>(law)) - o.best;
    const double mean = (o.share.array() * difference).sum(), blocks = static_cast<double>(difference.size());
    error = std::sqrt((o.share.array() * (difference - mean).square()).sum() / std::max(1.0, blocks - 1.0));
    return mean;
  };
  std::size_t best = laws.size();
  double most = 0.0, least = 0.0;
  for (std::size_t k = 0; k < laws.size(); ++k) {
    double fitting = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < choices.size(); ++i) {
      double error = 0.0;
      const double mean = worse(i, k, error);
      fitting += mean <= kSharedErrors * error;
      sum += std::max(-1.0, std::min(2.0, mean / std::max(error, 1e-300)));
    }
    if (fitting < most || (fitting == most && best < laws.size() && sum >= least)) continue;
    best = k;
    most = fitting;
    least = sum;
  }
  if (best == laws.size() || most <= 0.5 * static_cast<double>(choices.size())) return;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    double error = 0.0;
    if (worse(i, best, error) <= kSharedErrors * error) choices[i].law = laws[best];
  }
}

}  // namespace knee_robot::identification
