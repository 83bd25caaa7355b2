#include "knee_robot/identification/friction_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "friction_fits.h"
#include "friction_shared.h"

namespace knee_robot::identification {
namespace {

using dynamics::FrictionElement;
using dynamics::FrictionKind;

constexpr int kStops = 14, kSpeeds = 12, kBristleWidths = 7, kGrowing = 5;
constexpr double kGrows = 1.6;  ///< of the fastest speed at which friction alone is full: from there on beside another
constexpr double kBristleLeast_m = 2e-5;
const double kCreeps_m_per_s[] = {0.0, 3e-5, 1e-4, 1.7e-4, 3e-4, 1e-3};
const double kDampings_s[] = {0.0, 2.5e-3};
const double kTrembles[] = {0.5, 1.0};
const double kExponents[] = {1.5, 2.0};        // below 1: a stop beside bristles does the same
const double kSmoothExponents[] = {1.0, 3.0};  // above 1: next to nothing rubs while an axis creeps
const double kFinerFactors[] = {0.8, 0.87, 0.93, 0.97, 1.03, 1.07, 1.15, 1.25};
const double kFinerSides[] = {0.8, 0.9, 1.0, 1.12, 1.25};
constexpr double kFarApart = 2.0;
constexpr std::size_t kMostInSum = 6;
/// A simpler family is taken when it is within so many standard errors of the best. One would be usual; on the physical
/// robot it keeps the single stop, whose error on another path is up to half as large again (docs/identification.md).
constexpr double kWithinErrors = 0.25;
constexpr double kWorthAdding = 0.01;  ///< of the squares: an element that lowers them by less is not added to a sum

double geometric(double first, double last, int k, int count) {
  return first * std::pow(last / first, static_cast<double>(k) / (count - 1));
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
  return all;
}

/// Wider and narrower, and more and less of a second shape of `found`.
void addSides(const FrictionElement& found, double FrictionElement::*second, std::vector<FrictionElement>& all) {
  for (const double wider : kFinerSides) {
    for (const double more : kFinerSides) {
      if (wider == 1.0 && more == 1.0) continue;
      all.push_back(found);
      all.back().width_m *= wider;
      all.back().*second *= more;
    }
  }
}

/// Finer steps around the shapes that an earlier choice found for single elements.
void addFinerSteps(const FrictionChoice& around, double narrowest_m, std::vector<FrictionElement>& all) {
  for (const TriedLaw& tried : around.tried) {
    if (tried.law.count > 1) continue;
    const FrictionElement& found = tried.law.elements.front();
    if (found.kind == FrictionKind::Bristles && found.tremble > 0.0) {
      addSides(found, &FrictionElement::tremble, all);
    } else if (found.kind == FrictionKind::Bristles && found.exponent != 1.0) {
      addSides(found, &FrictionElement::exponent, all);
    } else if (found.kind == FrictionKind::Bristles && found.speed_m_per_s > 0.0) {
      addSides(found, &FrictionElement::speed_m_per_s, all);
    } else {
      for (const double factor : kFinerFactors) {
        FrictionElement e = found;
        (e.kind == FrictionKind::Smooth ? e.speed_m_per_s : e.width_m) *= factor;
        if (e.kind == FrictionKind::Smooth || e.width_m >= narrowest_m) all.push_back(e);
      }
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

/// A power of the velocity beside its tanh rises late and steeply, as Stribeck friction does: alone or not at all.
bool mixes(const FrictionElement& e) {
  return e.kind != FrictionKind::Smooth || e.exponent == 1.0;
}

/// Friction that goes on growing with the speed, ever less: beside what builds up near rest.
bool grows(const FrictionElement& e, const FrictionRange& range) {
  return e.kind == FrictionKind::Smooth && e.speed_m_per_s > 0.9 * kGrows * range.fastest_m_per_s;
}

Sum bestPair(const InWeights& squares, const std::vector<FrictionElement>& elements, const FrictionRange& range) {
  const int count = static_cast<int>(elements.size());
  Sum best;
  for (int i = 0; i < count; ++i) {
    for (int j = i + 1; j < count; ++j) {
      const FrictionElement &a = elements[static_cast<std::size_t>(i)], &b = elements[static_cast<std::size_t>(j)];
      if (mixes(a) && mixes(b) && apart(a, b) && !(grows(a, range) && grows(b, range)))
        keepBetter(best, tryThese(squares, {i, j}));
    }
  }
  return best;
}

/// Adds elements one after the other while that pays.
Sum bestSum(const InWeights& squares, const std::vector<FrictionElement>& elements, Sum sum) {
  const int count = static_cast<int>(elements.size());
  while (!sum.which.empty() && sum.which.size() < kMostInSum) {
    Sum more;
    for (int k = 0; k < count; ++k) {
      const bool near = std::any_of(sum.which.begin(), sum.which.end(), [&](int other) {
        return !apart(elements[static_cast<std::size_t>(k)], elements[static_cast<std::size_t>(other)]);
      });
      if (near || !mixes(elements[static_cast<std::size_t>(k)])) continue;
      std::vector<int> which = sum.which;
      which.push_back(k);
      keepBetter(more, tryThese(squares, which));
    }
    if (!(more.left < (1.0 - kWorthAdding) * sum.left)) break;
    sum = more;
  }
  return sum;
}

/// Simplest first; the numbers of shape parameters go with them.
std::vector<Sum> bestOfFamilies(const InWeights& squares, const std::vector<FrictionElement>& elements,
                                const FrictionRange& range) {
  const auto single = [&](const auto& allowed) { return bestSingle(squares, elements, allowed); };
  std::vector<Sum> best;
  best.push_back(single([](const FrictionElement& e) { return e.kind == FrictionKind::Stop; }));
  best.push_back(single([&](const FrictionElement& e) { return e.kind == FrictionKind::Smooth && !grows(e, range); }));
  best.push_back(single([](const FrictionElement& e) {
    return e.kind == FrictionKind::Bristles && e.speed_m_per_s == 0.0 && e.tremble == 0.0 && e.damping_s == 0.0 &&
           e.exponent == 1.0;
  }));
  best.push_back(single([](const FrictionElement& e) { return e.kind == FrictionKind::Bristles; }));
  best.push_back(bestPair(squares, elements, range));
  best.push_back(bestSum(squares, elements, best.back()));
  return best;
}
const int kNumbers[] = {1, 1, 1, 3, 4, 8};

dynamics::FrictionLaw lawOf(const Sum& sum, const std::vector<FrictionElement>& elements) {
  std::vector<FrictionElement> chosen;
  for (std::size_t k = 0; k < sum.which.size(); ++k) {
    chosen.push_back(elements[static_cast<std::size_t>(sum.which[k])]);
    chosen.back().share = sum.weights[static_cast<Eigen::Index>(k)];
  }
  return dynamics::lawOf(chosen);
}

/// All equations in the reduction's coordinates, without the part at zero coordinates.
struct InCoordinates {
  Eigen::MatrixXd x;
  Eigen::VectorXd y;
};

/// Factor of every row that makes rows near rest count as much as moving ones: that is where the law shows.
Eigen::VectorXd restAsMotion(const Equations& e, const Eigen::VectorXd& noise_N) {
  Eigen::VectorXd factor = Eigen::VectorXd::Ones(e.rows());
  if (noise_N.size() <= e.axes) return factor;
  Eigen::VectorXd resting = Eigen::VectorXd::Zero(e.axes);
  const double each = static_cast<double>(e.rows()) / e.axes;
  for (int row = 0; row < e.rows(); ++row)
    resting[e.actuator[static_cast<std::size_t>(row)]] += e.rest[static_cast<std::size_t>(row)] ? 1.0 / each : 0.0;
  for (int row = 0; row < e.rows(); ++row) {
    const int i = e.actuator[static_cast<std::size_t>(row)];
    const double moves = noise_N[i], rests = noise_N[i + e.axes];
    const double all = std::sqrt((1.0 - resting[i]) * moves * moves + resting[i] * rests * rests);
    factor[row] = (e.rest[static_cast<std::size_t>(row)] ? rests : moves) / all;
  }
  return factor;
}

InCoordinates inCoordinates(const Equations& e, const Reduction& r, const Eigen::VectorXd& factor) {
  Eigen::MatrixXd basis(e.a.cols(), r.maximalRank());
  for (Eigen::Index k = 0; k < basis.cols(); ++k)
    basis.col(k) = toParameters(r, Eigen::VectorXd::Unit(basis.cols(), k)) - r.start;
  return {factor.asDiagonal() * (e.a * basis), factor.cwiseProduct(e.b - e.a * r.start)};
}

/// Sums of squares of every block. `candidates`: at the rows of the actuator, which start at `first`.
std::vector<FrictionBlock> sumsOfBlocks(const Equations& e, const InCoordinates& all, Eigen::Index without,
                                        const Eigen::MatrixXd& candidates, Eigen::Index first) {
  std::vector<int> keep(static_cast<std::size_t>(all.x.cols()));
  std::iota(keep.begin(), keep.end(), 0);
  if (without >= 0) keep.erase(keep.begin() + without);
  std::vector<FrictionBlock> blocks;
  for (int block = 0; block < e.blocks; ++block) {
    std::vector<Eigen::Index> rows, own;
    for (Eigen::Index row = 0; row < e.rows(); ++row) {
      if (e.block[static_cast<std::size_t>(row)] != block) continue;
      rows.push_back(row);
      if (row >= first && row < first + candidates.rows()) own.push_back(row);
    }
    const Eigen::MatrixXd x = all.x(rows, keep);
    const Eigen::VectorXd y = all.y(rows);
    std::vector<Eigen::Index> in_candidates;
    for (const Eigen::Index row : own)
      in_candidates.push_back(row - first);
    const Eigen::MatrixXd c = candidates(in_candidates, Eigen::all), own_x = all.x(own, keep);
    const Eigen::VectorXd own_y = all.y(own);
    blocks.push_back({x.transpose() * x, own_x.transpose() * c, c.transpose() * c, x.transpose() * y,
                      c.transpose() * own_y, y.squaredNorm(), static_cast<double>(rows.size())});
  }
  return blocks;
}

/// Mean square on held-back rows of a law whose shares are given: only its size is fitted.
double errorOfLaw(const InWeights& training, const InWeights& held, const Sum& law) {
  InWeights one = training;
  one.constant = 0.0;
  one.linear.setZero();
  const double square = one.at(law.which, law.weights);
  double linear = 0.0;
  for (std::size_t k = 0; k < law.which.size(); ++k)
    linear += law.weights[static_cast<Eigen::Index>(k)] * training.linear[law.which[k]];
  return held.at(law.which, std::max(0.0, linear / std::max(square, 1e-300)) * law.weights);
}

/// `laws`: of other actuators, in `elements`.
FrictionChoice chooseFrom(const std::vector<FrictionBlock>& blocks, const Eigen::VectorXd& ridge,
                          const std::vector<FrictionElement>& elements, const FrictionRange& range,
                          const std::vector<Sum>& laws, OthersLaws& others) {
  FrictionBlock everything;
  for (const FrictionBlock& b : blocks)
    everything += b;
  const Eigen::Index families = static_cast<Eigen::Index>(std::size(kNumbers));
  Eigen::MatrixXd error(static_cast<Eigen::Index>(blocks.size()), families);
  Eigen::VectorXd share(error.rows());
  others.error.resize(error.rows(), static_cast<Eigen::Index>(laws.size()));
  InWeights training, held;
  for (Eigen::Index b = 0; b < error.rows(); ++b) {
    const FrictionBlock& out = blocks[static_cast<std::size_t>(b)];
    share[b] = out.rows / everything.rows;
    eliminateBase(everything.minus(out), out, ridge, training, held);
    const std::vector<Sum> best = bestOfFamilies(training, elements, range);
    for (Eigen::Index f = 0; f < families; ++f) {
      const Sum& sum = best[static_cast<std::size_t>(f)];
      error(b, f) = (sum.which.empty() ? held.constant : held.at(sum.which, sum.weights)) / std::max(1.0, out.rows);
    }
    for (std::size_t k = 0; k < laws.size(); ++k)
      others.error(b, static_cast<Eigen::Index>(k)) = errorOfLaw(training, held, laws[k]) / std::max(1.0, out.rows);
  }
  eliminateBase(everything, everything, ridge, training, held);
  const std::vector<Sum> best = bestOfFamilies(training, elements, range);
  const Eigen::RowVectorXd mean = share.transpose() * error;
  Eigen::Index least = 0;
  mean.minCoeff(&least);
  others.best = error.col(least);
  others.share = share;
  FrictionChoice choice;
  bool chosen = false;
  for (Eigen::Index f = 0; f < families; ++f) {
    const Sum& sum = best[static_cast<std::size_t>(f)];
    if (sum.which.empty()) continue;
    TriedLaw tried;
    tried.law = lawOf(sum, elements);
    tried.numbers = kNumbers[f];
    tried.held_back = mean[f];
    tried.beyond_best = mean[f] - mean[least];
    const Eigen::VectorXd worse = error.col(f) - error.col(least);
    const double variance = (share.array() * (worse.array() - tried.beyond_best).square()).sum();
    tried.standard_error = std::sqrt(variance / std::max<Eigen::Index>(1, error.rows() - 1));
    if (!chosen && tried.beyond_best <= kWithinErrors * tried.standard_error) {
      choice.law = tried.law;
      chosen = true;
    }
    choice.tried.push_back(tried);
  }
  return choice;
}

}  // namespace

std::vector<FrictionChoice> chooseFriction(const std::vector<Observation>& training, const ObservationOptions& options,
                                           const std::vector<Column>& columns, const Equations& e,
                                           const Eigen::VectorXd& noise_N, const Reduction& r, double strength,
                                           const std::vector<FrictionRange>& ranges,
                                           const std::vector<FrictionChoice>& around) {
  const Eigen::VectorXd factor = restAsMotion(e, noise_N);
  const InCoordinates all = inCoordinates(e, r, factor);
  const Eigen::Index each = e.rows() / e.axes;
  std::vector<FrictionChoice> choices;
  const std::vector<dynamics::FrictionLaw> shared =
      e.axes > 1 ? sharedLaws(around) : std::vector<dynamics::FrictionLaw>();
  std::vector<OthersLaws> others(static_cast<std::size_t>(e.axes));
  for (int i = 0; i < e.axes; ++i) {
    const std::size_t axis = static_cast<std::size_t>(i);
    std::vector<FrictionElement> elements = elementsToTry(ranges[axis]);
    if (!around.empty()) addFinerSteps(around[axis], ranges[axis].narrowest_m, elements);
    const std::vector<Sum> laws = inElements(shared, elements);
    Eigen::MatrixXd candidates(each, static_cast<Eigen::Index>(elements.size()));
    for (std::size_t k = 0; k < elements.size(); ++k) {
      std::vector<Eigen::VectorXd> share;
      for (const Observation& o : training)
        share.push_back(atLevel(o, axis, elementShare(o.sliding[axis], elements[k])));
      candidates.col(static_cast<Eigen::Index>(k)) = atRows(training, options, e, i, share);
    }
    for (Eigen::Index row = 0; row < each; ++row) {
      const bool rest = noise_N.size() > e.axes && e.rest[static_cast<std::size_t>(i * each + row)];
      candidates.row(row) *= factor[i * each + row] / noise_N[i + (rest ? e.axes : 0)];
    }
    Eigen::Index without = -1;  // the coordinate of its own Coulomb friction
    for (std::size_t k = 0; k < r.kept.size(); ++k) {
      const Column& c = columns[static_cast<std::size_t>(r.kept[k])];
      if (c.role == ColumnRole::Coulomb && c.actuator == i) without = static_cast<Eigen::Index>(k);
    }
    Eigen::VectorXd ridge = Eigen::VectorXd::Zero(all.x.cols() - (without >= 0 ? 1 : 0));
    ridge.tail(r.directions.cols()).setConstant(strength);
    choices.push_back(chooseFrom(sumsOfBlocks(e, all, without, candidates, i * each), ridge, elements, ranges[axis],
                                 laws, others[axis]));
  }
  std::vector<double> narrowest_m;
  for (const FrictionRange& range : ranges)
    narrowest_m.push_back(range.narrowest_m);
  shareLaw(shared, others, narrowest_m, choices);
  return choices;
}

}  // namespace knee_robot::identification
