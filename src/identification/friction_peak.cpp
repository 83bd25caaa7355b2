#include "friction_peak.h"

#include <algorithm>
#include <cmath>

#include "friction_families.h"

namespace knee_robot::identification {
namespace {

using dynamics::FrictionElement;
using dynamics::FrictionKind;

constexpr int kPeakSpeeds = 4, kPeakWidths = 4;
constexpr double kFastestPeak_m_per_s = 2e-3;  ///< Stribeck friction as an effect begins there
constexpr double kSlowestShare = 2.0, kFastestShare = 0.4, kNarrowestShare = 0.15;  ///< of the range's ends
constexpr double kWider = 3.0;           ///< bristles that are taken away, than what they are taken away from
constexpr double kLeastPeak = 0.04;      ///< share of all weights
constexpr double kMostPeak = 1.0 / 3.0;  ///< of what builds up: friction near rest is at most half as large again
constexpr std::size_t kMostInPeak = 4;
const double kFinerPeak[] = {0.7, 0.84, 1.19, 1.4};

bool isTaken(const FrictionElement& e) {
  return e.share < 0.0;
}

const FrictionElement& of(const std::vector<FrictionElement>& elements, int k) {
  return elements[static_cast<std::size_t>(k)];
}

/// Empty where the peak would be too small or too large.
Sum withPeak(const InWeights& squares, const std::vector<FrictionElement>& elements, std::vector<int> which) {
  Sum sum;
  const Eigen::VectorXd weights = positiveWeights(squares, which, kLeastPeak);
  if (weights.size() == 0) return sum;
  double taken = 0.0;
  for (std::size_t k = 0; k < which.size(); ++k)
    taken += isTaken(of(elements, which[k])) ? weights[static_cast<Eigen::Index>(k)] : 0.0;
  if (taken > kMostPeak * (weights.sum() - taken)) return sum;
  sum.left = squares.at(which, weights);
  sum.weights = weights;
  sum.which = std::move(which);
  return sum;
}

/// Builds up before `taken` takes away: the peak lies between the two.
bool buildsUpBefore(const FrictionElement& e, const FrictionElement& taken) {
  if (e.kind == FrictionKind::Smooth) return false;
  return taken.kind == FrictionKind::Smooth || kWider * e.width_m <= taken.width_m;
}

}  // namespace

void addTakenAway(const FrictionRange& range, std::vector<FrictionElement>& all) {
  const double slowest = kSlowestShare * range.slowest_m_per_s,
               fastest = std::max(2.0 * slowest, std::min(kFastestPeak_m_per_s, kFastestShare * range.fastest_m_per_s));
  for (int k = 0; k < kPeakSpeeds; ++k)
    all.push_back({FrictionKind::Smooth, -1.0, 0.0, geometric(slowest, fastest, k, kPeakSpeeds)});
  for (int k = 0; k < kPeakWidths; ++k)
    all.push_back({FrictionKind::Bristles, -1.0,
                   geometric(kNarrowestShare * range.bristles_most_m, range.bristles_most_m, k, kPeakWidths)});
}

void addFinerPeak(const dynamics::FrictionLaw& found, std::vector<FrictionElement>& all) {
  for (int k = 0; k < found.count; ++k) {
    if (!isTaken(found.elements[static_cast<std::size_t>(k)])) continue;
    for (const double factor : kFinerPeak) {
      FrictionElement finer = found.elements[static_cast<std::size_t>(k)];
      finer.share = -1.0;
      (finer.kind == FrictionKind::Smooth ? finer.speed_m_per_s : finer.width_m) *= factor;
      if (finer.kind != FrictionKind::Smooth || finer.speed_m_per_s <= kFastestPeak_m_per_s) all.push_back(finer);
    }
  }
}

std::vector<Sum> bestPeaks(const InWeights& squares, const std::vector<FrictionElement>& elements,
                           const std::vector<int>& mixing) {
  Sum pair;
  for (int taken = 0; taken < static_cast<int>(elements.size()); ++taken) {
    const FrictionElement& b = of(elements, taken);
    if (!isTaken(b)) continue;
    for (const int k : mixing) {
      const FrictionElement& a = of(elements, k);
      if (!buildsUpBefore(a, b)) continue;
      Sum tried = withPeak(squares, elements, {k, taken});
      if (tried.left < pair.left) pair = std::move(tried);
    }
  }
  Sum sum = pair;
  while (!sum.which.empty() && sum.which.size() < kMostInPeak) {
    Sum more;
    for (const int k : mixing) {
      if (!buildsUpBefore(of(elements, k), of(elements, pair.which[1]))) continue;
      std::vector<int> which = sum.which;
      which.push_back(k);
      Sum tried = withPeak(squares, elements, std::move(which));
      if (tried.left < more.left) more = std::move(tried);
    }
    if (!(more.left < (1.0 - kWorthAdding) * sum.left)) break;
    sum = std::move(more);
  }
  return {pair, sum};
}

}  // namespace knee_robot::identification
