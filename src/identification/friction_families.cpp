#include "friction_families.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "friction_peak.h"

namespace knee_robot::identification {
namespace {

using dynamics::FrictionElement;
using dynamics::FrictionKind;
using dynamics::SmoothShape;

constexpr int kStops = 14, kSpeeds = 12, kBristleWidths = 7, kGrowing = 5;
constexpr double kGrows = 1.6;  ///< of the fastest speed at which friction alone is full: from there on beside another
constexpr double kBristleLeast_m = 2e-5;
const double kCreeps_m_per_s[] = {0.0, 3e-5, 1e-4, 1.7e-4, 3e-4, 1e-3};
const double kDampings_s[] = {0.0, 2.5e-3};
const double kTrembles[] = {0.5, 1.0};
const double kExponents[] = {1.5, 2.0};        // below 1: a stop beside bristles does the same
const double kSmoothExponents[] = {1.0, 3.0};  // above 1: next to nothing rubs while an axis creeps
const double kGaps[] = {0.5, 1.0, 2.0};        // of the width
const double kRelaxations_s[] = {2.0, 6.0};    // what fades within a second of rest is a controller that settles
const SmoothShape kOtherShapes[] = {SmoothShape::Ramp, SmoothShape::Rational, SmoothShape::Root,
                                    SmoothShape::Arctangent};
const double kLags_s[] = {0.015, 0.025, 0.04};
constexpr double kLeastLag_s = 0.01;  ///< less is what the timing of rows does
const double kFinerFactors[] = {0.8, 0.87, 0.93, 0.97, 0.985, 0.993, 1.007, 1.015, 1.03, 1.07, 1.15, 1.25};
const double kFinerSides[] = {0.8, 0.9, 1.0, 1.12, 1.25};
constexpr double kFarApart = 2.0;
constexpr std::size_t kMostInSum = 6;
constexpr double kLeastOfSpectrum = 0.03;  ///< share of one beside many
constexpr double kAlike = 0.3;             ///< distance of two speeds' logarithms: finer steps are not in a spectrum
constexpr double kSlightly = 1e-6;         ///< of a column's own square: stops of neighbouring widths are alike

/// More and less of two shapes of `found`.
void addSides(const FrictionElement& found, double FrictionElement::*first, double FrictionElement::*second,
              std::vector<FrictionElement>& all) {
  for (const double wider : kFinerSides) {
    for (const double more : kFinerSides) {
      if (wider == 1.0 && more == 1.0) continue;
      all.push_back(found);
      all.back().*first *= wider;
      all.back().*second *= more;
    }
  }
}

Sum tryThese(const InWeights& squares, std::vector<int> which) {
  Sum sum;
  sum.weights = positiveWeights(squares, which);
  if (sum.weights.size() == 0) return sum;
  sum.left = squares.at(which, sum.weights);
  sum.which = std::move(which);
  return sum;
}

void keepBetter(Sum& best, Sum other) {
  if (other.left < best.left) best = std::move(other);
}

template <typename Allowed>
Sum bestSingle(const InWeights& squares, const std::vector<FrictionElement>& elements, const Allowed& allowed) {
  Sum best;
  for (int k = 0; k < static_cast<int>(elements.size()); ++k) {
    if (allowed(elements[static_cast<std::size_t>(k)])) keepBetter(best, tryThese(squares, {k}));
  }
  return best;
}

/// Neighbours on the grids are one element that lies between them, not two.
bool apart(const FrictionElement& a, const FrictionElement& b) {
  if (a.kind != b.kind) return true;
  const auto far = [](double x, double y) { return std::max(x, y) > kFarApart * std::min(x, y); };
  return a.kind == FrictionKind::Smooth ? far(a.speed_m_per_s, b.speed_m_per_s) : far(a.width_m, b.width_m);
}

/// Friction that goes on growing with the speed, ever less: beside what builds up near rest.
bool grows(const FrictionElement& e, const FrictionRange& range) {
  return e.kind == FrictionKind::Smooth && e.speed_m_per_s > 0.9 * kGrows * range.fastest_m_per_s;
}

/// `firsts`, `seconds`: in `elements`; the same vector for all pairs of these.
Sum bestPair(const InWeights& squares, const std::vector<FrictionElement>& elements, const FrictionRange& range,
             const std::vector<int>& firsts, const std::vector<int>& seconds) {
  double least = std::numeric_limits<double>::infinity();
  std::vector<int> best;
  for (std::size_t i = 0; i < firsts.size(); ++i) {
    for (std::size_t j = &firsts == &seconds ? i + 1 : 0; j < seconds.size(); ++j) {
      const double left = leftByPair(squares, firsts[i], seconds[j]);
      if (!(left < least)) continue;
      const FrictionElement &a = elements[static_cast<std::size_t>(firsts[i])],
                            &b = elements[static_cast<std::size_t>(seconds[j])];
      if (!apart(a, b) || (grows(a, range) && grows(b, range))) continue;
      least = left;
      best = {firsts[i], seconds[j]};
    }
  }
  return best.empty() ? Sum() : tryThese(squares, best);
}

/// Adds elements of these one after the other while that pays.
Sum bestSum(const InWeights& squares, const std::vector<FrictionElement>& elements, const std::vector<int>& mixing,
            Sum sum) {
  while (!sum.which.empty() && sum.which.size() < kMostInSum) {
    Sum more;
    for (const int k : mixing) {
      const bool near = std::any_of(sum.which.begin(), sum.which.end(), [&](int other) {
        return !apart(elements[static_cast<std::size_t>(k)], elements[static_cast<std::size_t>(other)]);
      });
      if (near) continue;
      std::vector<int> which = sum.which;
      which.push_back(k);
      keepBetter(more, tryThese(squares, which));
    }
    if (!(more.left < (1.0 - kWorthAdding) * sum.left)) break;
    sum = more;
  }
  return sum;
}

/// All of these at once with the non-negative shares that leave least, the smallest left out while it is next to
/// nothing. Adding one after the other ends beside it, where no single one helps.
Sum spectrumOf(const InWeights& squares, std::vector<int> which) {
  Sum sum;
  sum.which = std::move(which);
  while (!sum.which.empty()) {
    Eigen::MatrixXd square = squares.square(sum.which, sum.which);
    square.diagonal() *= 1.0 + kSlightly;
    const Eigen::LLT<Eigen::MatrixXd> root(square);
    sum.weights = boundedLeastSquares(root.matrixU(), root.matrixL().solve(squares.linear(sum.which)),
                                      static_cast<int>(sum.which.size()));
    Eigen::Index least = 0;
    sum.weights.minCoeff(&least);
    if (sum.which.size() <= dynamics::kMostFrictionElements &&
        sum.weights[least] >= kLeastOfSpectrum * sum.weights.sum())
      break;
    sum.which.erase(sum.which.begin() + least);
  }
  if (sum.which.empty() || !sum.weights.allFinite() || sum.weights.sum() <= 0.0) return {};
  sum.left = squares.at(sum.which, sum.weights);
  return sum;
}

/// Maxwell slip.
Sum spectrumOfStops(const InWeights& squares) {
  std::vector<int> stops(kStops);
  std::iota(stops.begin(), stops.end(), 0);
  return spectrumOf(squares, std::move(stops));
}

/// Any friction that depends on the velocity alone and grows with it ever less: a logarithm, an arctangent.
Sum spectrumOfSpeeds(const InWeights& squares, const std::vector<FrictionElement>& elements) {
  std::vector<int> smooth;
  for (int k = 0; k < static_cast<int>(squares.linear.size()); ++k) {
    const FrictionElement& e = elements[static_cast<std::size_t>(k)];
    if (e.kind != FrictionKind::Smooth || e.exponent != 1.0 || e.smooth != SmoothShape::Tanh || e.lag_s > 0.0 ||
        e.share < 0.0)
      continue;
    const bool near = std::any_of(smooth.begin(), smooth.end(), [&](int other) {
      return std::abs(std::log(e.speed_m_per_s / elements[static_cast<std::size_t>(other)].speed_m_per_s)) < kAlike;
    });
    if (!near) smooth.push_back(k);
  }
  return spectrumOf(squares, std::move(smooth));
}

}  // namespace

bool mixes(const FrictionElement& e) {
  return e.gap_m == 0.0 && e.lag_s == 0.0 && e.smooth == SmoothShape::Tanh &&
         (e.kind != FrictionKind::Smooth || e.exponent == 1.0);
}

int mixingFirst(std::vector<FrictionElement>& elements, std::vector<Sum>& laws) {
  std::vector<int> order(elements.size()), now(elements.size());
  std::iota(order.begin(), order.end(), 0);
  const auto end = std::stable_partition(order.begin(), order.end(),
                                         [&](int k) { return mixes(elements[static_cast<std::size_t>(k)]); });
  std::vector<FrictionElement> sorted;
  for (const int k : order) {
    now[static_cast<std::size_t>(k)] = static_cast<int>(sorted.size());
    sorted.push_back(elements[static_cast<std::size_t>(k)]);
  }
  elements = std::move(sorted);
  for (Sum& law : laws) {
    for (int& k : law.which)
      k = now[static_cast<std::size_t>(k)];
  }
  return static_cast<int>(end - order.begin());
}

std::vector<FrictionElement> elementsToTry(const FrictionRange& range) {
  const double narrowest_m = range.narrowest_m;
  std::vector<FrictionElement> all;
  for (int k = 0; k < kStops; ++k)
    all.push_back({FrictionKind::Stop, 1.0,
                   geometric(std::min(narrowest_m, 0.5 * range.widest_m), range.widest_m, k, kStops), 0.0, 0.0});
  for (int k = 0; k < kSpeeds; ++k) {
    for (const double exponent : kSmoothExponents) {
      FrictionElement e{FrictionKind::Smooth, 1.0, 0.0,
                        geometric(range.slowest_m_per_s, range.fastest_m_per_s, k, kSpeeds)};
      e.exponent = exponent;
      all.push_back(e);
    }
    for (const SmoothShape shape : kOtherShapes) {
      all.push_back(
          {FrictionKind::Smooth, 1.0, 0.0, geometric(range.slowest_m_per_s, range.fastest_m_per_s, k, kSpeeds)});
      all.back().smooth = shape;
    }
  }
  for (int k = 0; k < kSpeeds; k += 2) {
    FrictionElement e{FrictionKind::Smooth, 1.0, 0.0,
                      geometric(range.slowest_m_per_s, range.fastest_m_per_s, k, kSpeeds)};
    for (const double lag_s : kLags_s) {
      e.lag_s = lag_s;
      all.push_back(e);
    }
  }
  const double from_m_per_s = kGrows * range.fastest_m_per_s;
  for (int k = 0; k < kGrowing && range.growing_m_per_s > from_m_per_s; ++k)
    all.push_back({FrictionKind::Smooth, 1.0, 0.0, geometric(from_m_per_s, range.growing_m_per_s, k, kGrowing)});
  const double least = std::min(std::max(kBristleLeast_m, narrowest_m), 0.5 * range.bristles_most_m);
  for (int k = 0; k < kBristleWidths; ++k) {
    for (const double creep : kCreeps_m_per_s) {
      for (const double damping : kDampings_s)
        all.push_back(
            {FrictionKind::Bristles, 1.0, geometric(least, range.bristles_most_m, k, kBristleWidths), creep, damping});
    }
    for (const double exponent : kExponents) {
      FrictionElement e{FrictionKind::Bristles, 1.0, geometric(least, range.bristles_most_m, k, kBristleWidths)};
      e.exponent = exponent;
      all.push_back(e);
    }
    for (const double tremble : kTrembles) {
      for (const double damping : kDampings_s)
        all.push_back({FrictionKind::Bristles, 1.0, geometric(least, range.bristles_most_m, k, kBristleWidths), 0.0,
                       damping, tremble});
    }
  }
  for (int k = 0; k < kBristleWidths; ++k) {
    FrictionElement e{FrictionKind::Stop, 1.0, geometric(least, range.bristles_most_m, k, kBristleWidths), 0.0, 0.0};
    for (const double relaxation_s : kRelaxations_s) {
      e.relaxation_s = relaxation_s;
      all.push_back(e);
    }
    e.relaxation_s = 0.0;
    for (const double gap : kGaps) {
      e.gap_m = gap * e.width_m;
      all.push_back(e);
    }
  }
  if (range.peak) addTakenAway(range, all);
  return all;
}

void addFinerSteps(const FrictionChoice& around, double narrowest_m, std::vector<FrictionElement>& all) {
  for (const TriedLaw& tried : around.tried) {
    addFinerPeak(tried.law, all);
    if (tried.law.count > 1) continue;
    const FrictionElement& found = tried.law.elements.front();
    if (found.lag_s > 0.0) {
      addSides(found, &FrictionElement::speed_m_per_s, &FrictionElement::lag_s, all);
      all.erase(
          std::remove_if(all.begin(), all.end(), [](const auto& e) { return e.lag_s > 0.0 && e.lag_s < kLeastLag_s; }),
          all.end());
    } else if (found.gap_m > 0.0) {
      addSides(found, &FrictionElement::width_m, &FrictionElement::gap_m, all);
    } else if (found.relaxation_s > 0.0) {
      addSides(found, &FrictionElement::width_m, &FrictionElement::relaxation_s, all);
    } else if (found.kind == FrictionKind::Bristles && found.tremble > 0.0) {
      addSides(found, &FrictionElement::width_m, &FrictionElement::tremble, all);
    } else if (found.kind == FrictionKind::Bristles && found.exponent != 1.0) {
      addSides(found, &FrictionElement::width_m, &FrictionElement::exponent, all);
    } else if (found.kind == FrictionKind::Bristles && found.speed_m_per_s > 0.0) {
      addSides(found, &FrictionElement::width_m, &FrictionElement::speed_m_per_s, all);
    } else {
      for (const double factor : kFinerFactors) {
        FrictionElement e = found;
        (e.kind == FrictionKind::Smooth ? e.speed_m_per_s : e.width_m) *= factor;
        if (e.kind == FrictionKind::Smooth || e.width_m >= narrowest_m) all.push_back(e);
      }
    }
  }
}

std::vector<Sum> bestOfFamilies(const InWeights& squares, const std::vector<FrictionElement>& elements,
                                const FrictionRange& range) {
  const auto single = [&](const auto& allowed) {
    return bestSingle(squares, elements, [&](const FrictionElement& e) { return !isRare(e) && allowed(e); });
  };
  std::vector<int> mixing, rare;
  for (int k = 0; k < static_cast<int>(elements.size()); ++k) {
    const FrictionElement& e = elements[static_cast<std::size_t>(k)];
    if (mixes(e) && e.share > 0.0) (isRare(e) ? rare : mixing).push_back(k);
  }
  std::vector<Sum> best;
  best.push_back(single([](const FrictionElement& e) { return e.kind == FrictionKind::Stop; }));
  best.push_back(single([&](const FrictionElement& e) {
    return e.kind == FrictionKind::Smooth && e.smooth == SmoothShape::Tanh && !grows(e, range);
  }));
  best.push_back(single([](const FrictionElement& e) {
    return e.kind == FrictionKind::Bristles && e.speed_m_per_s == 0.0 && e.tremble == 0.0 && e.damping_s == 0.0 &&
           e.exponent == 1.0;
  }));
  for (const SmoothShape shape : {SmoothShape::Rational, SmoothShape::Root, SmoothShape::Arctangent})
    best.push_back(single([&](const FrictionElement& e) { return e.smooth == shape; }));
  best.push_back(single([](const FrictionElement& e) { return e.kind == FrictionKind::Bristles; }));
  best.push_back(spectrumOfStops(squares));
  best.push_back(bestPair(squares, elements, range, mixing, mixing));
  best.push_back(bestSum(squares, elements, mixing, best.back()));
  best.push_back(spectrumOfSpeeds(squares, elements));
  best.push_back(bestSingle(squares, elements, [](const FrictionElement& e) { return e.smooth == SmoothShape::Ramp; }));
  best.push_back(bestSingle(squares, elements, [](const FrictionElement& e) { return e.lag_s > 0.0; }));
  best.push_back(bestSingle(squares, elements,
                            [](const FrictionElement& e) { return isRare(e) && e.lag_s == 0.0 && e.share > 0.0; }));
  best.push_back(bestPair(squares, elements, range, rare, mixing));
  best.push_back(bestSum(squares, elements, mixing, best.back()));
  for (Sum& peak : range.peak ? bestPeaks(squares, elements, mixing) : std::vector<Sum>(2))
    best.push_back(std::move(peak));
  return best;
}

}  // namespace knee_robot::identification
