#include "knee_robot/identification/friction_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "friction_families.h"
#include "friction_simplest.h"
#include "knee_robot/base/parallel.h"

namespace knee_robot::identification {
namespace {

using dynamics::FrictionElement;

/// One with a rare element is taken when it is better than the best without by so many. Without this, legs of a
/// physical robot that stand while its controller settles got stops that relax, and predicted another day up to 44 % worse.
constexpr double kSurelyRare = 2.0;
/// A tanh that lags and a peak also when they leave less than this of what that leaves: few blocks may hold all of it.
constexpr double kHalves = 0.5;
/// They have to leave at most this of what the usual laws leave in any case: a percent or two of a recording that the
/// model hardly describes moved the laws of its other axes.
constexpr double kWorthALaw = 0.8;
/// One that relaxes, and a ramp: this much. Where training hardly rests what relaxes may be surely better by half a
/// percent, and is wrong by a whole friction at rest; on the physical robots it leaves 0.97 or less.
constexpr double kWorthALittle = 0.98;

/// In rows of unit noise: an effect's size may change by about itself.
constexpr double kSizeAsFound = 1.0;

dynamics::FrictionLaw lawOf(const Sum& sum, const std::vector<FrictionElement>& elements) {
  std::vector<FrictionElement> chosen;
  for (std::size_t k = 0; k < sum.which.size(); ++k) {
    chosen.push_back(elements[static_cast<std::size_t>(sum.which[k])]);
    chosen.back().share *= sum.weights[static_cast<Eigen::Index>(k)];
  }
  return dynamics::lawOf(chosen);
}

bool relaxes(const Sum& sum, const std::vector<FrictionElement>& elements) {
  return std::any_of(sum.which.begin(), sum.which.end(),
                     [&](int k) { return elements[static_cast<std::size_t>(k)].relaxation_s > 0.0; });
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

/// What turns forces at rows into what chooseFriction compares.
Eigen::VectorXd rowWeights(const Equations& e, const Eigen::VectorXd& noise_N, const Eigen::VectorXd& factor) {
  Eigen::VectorXd weight(e.rows());
  for (int row = 0; row < e.rows(); ++row) {
    const int i = e.actuator[static_cast<std::size_t>(row)];
    const bool rest = noise_N.size() > e.axes && e.rest[static_cast<std::size_t>(row)];
    weight[row] = factor[row] / noise_N[i + (rest ? e.axes : 0)];
  }
  return weight;
}

/// Forces of effects that stand beside the model (Observation::beside_N) at all rows, in units of their noise.
Eigen::MatrixXd besideAt(const std::vector<Observation>& training, const ObservationOptions& options,
                         const Equations& e, const Eigen::VectorXd& row_weight) {
  const std::size_t effects = training.front().beside_N.size();
  Eigen::MatrixXd out(e.rows(), static_cast<Eigen::Index>(effects));
  if (effects == 0) return out;
  const Eigen::Index each = e.rows() / e.axes;
  for (int i = 0; i < e.axes; ++i) {
    std::vector<Eigen::MatrixXd> forces;
    for (const Observation& o : training) {
      forces.emplace_back(o.samples(), out.cols());
      for (std::size_t k = 0; k < effects; ++k)
        forces.back().col(static_cast<Eigen::Index>(k)) = o.beside_N[k].col(i);
    }
    out.middleRows(i * each, each) = atRows(training, options, e, i, std::move(forces));
  }
  return row_weight.asDiagonal() * out;
}

/// Rows of a block that lie in first .. first + count - 1.
std::vector<Eigen::Index> rowsIn(const Equations& e, int block, Eigen::Index first, Eigen::Index count) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index row = first; row < first + count; ++row) {
    if (e.block[static_cast<std::size_t>(row)] == block) rows.push_back(row);
  }
  return rows;
}

/// Sums of squares of every block, of the base alone: the same for all actuators.
std::vector<FrictionBlock> sumsOfBase(const Equations& e, const InCoordinates& all) {
  std::vector<FrictionBlock> blocks(static_cast<std::size_t>(e.blocks));
  inParallel(blocks.size(), [&](std::size_t block) {
    const std::vector<Eigen::Index> rows = rowsIn(e, static_cast<int>(block), 0, e.rows());
    const Eigen::MatrixXd x = all.x(rows, Eigen::all);
    const Eigen::VectorXd y = all.y(rows);
    FrictionBlock& sums = blocks[block];
    sums.base = x.transpose() * x;
    sums.base_target = x.transpose() * y;
    sums.target = y.squaredNorm();
    sums.rows = static_cast<double>(rows.size());
  });
  return blocks;
}

/// Those with candidates at the rows of one actuator, which start at `first`, in place of the coordinate `without` (-1:
/// none). `mixing`: so many candidates may stand beside others.
std::vector<FrictionBlock> sumsOfBlocks(const Equations& e, const InCoordinates& all,
                                        const std::vector<FrictionBlock>& base, Eigen::Index without,
                                        const Eigen::MatrixXd& candidates, int mixing, Eigen::Index first) {
  std::vector<int> keep(static_cast<std::size_t>(all.x.cols()));
  std::iota(keep.begin(), keep.end(), 0);
  if (without >= 0) keep.erase(keep.begin() + without);
  std::vector<FrictionBlock> blocks;
  for (int block = 0; block < e.blocks; ++block) {
    const std::vector<Eigen::Index> own = rowsIn(e, block, first, candidates.rows());
    std::vector<Eigen::Index> in_candidates;
    in_candidates.reserve(own.size());
    for (const Eigen::Index row : own)
      in_candidates.push_back(row - first);
    const Eigen::MatrixXd c = candidates(in_candidates, Eigen::all), own_x = all.x(own, keep);
    const Eigen::VectorXd own_y = all.y(own);
    const FrictionBlock& sums = base[static_cast<std::size_t>(block)];
    Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(mixing, mixing);
    squares.selfadjointView<Eigen::Lower>().rankUpdate(c.leftCols(mixing).transpose());
    squares.triangularView<Eigen::StrictlyUpper>() = squares.transpose();
    blocks.push_back({sums.base(keep, keep), own_x.transpose() * c, squares, c.colwise().squaredNorm().transpose(),
                      sums.base_target(keep), c.transpose() * own_y, sums.target, sums.rows});
  }
  return blocks;
}

constexpr std::size_t kAtOnce = 16;  ///< elements: low-passed side by side, without a copy of the whole for long ones

/// Of some elements along one axis' path in every recording.
std::vector<Eigen::MatrixXd> sharesOf(const std::vector<Observation>& training, std::size_t axis,
                                      const std::vector<FrictionElement>& elements, std::size_t from,
                                      std::size_t count) {
  std::vector<Eigen::MatrixXd> shares;
  for (const Observation& o : training) {
    shares.emplace_back(o.samples(), static_cast<Eigen::Index>(count));
    for (std::size_t k = 0; k < count; ++k)
      shares.back().col(static_cast<Eigen::Index>(k)) =
          atLevel(o, axis, elementShare(o.sliding[axis], elements[from + k])) * elements[from + k].share;
  }
  return shares;
}

/// Squares on held-back rows of a law whose shares are given: only its size is fitted.
double leftByLaw(const InWeights& training, const FittedBase& fitted, const FrictionBlock& held_back, const Sum& law) {
  return fitted.leftOn(held_back, law.which, std::max(0.0, training.along(law.which, law.weights)) * law.weights);
}

Worse worseBy(const Eigen::MatrixXd& error, const Eigen::VectorXd& share, Eigen::Index family, Eigen::Index than) {
  const Eigen::ArrayXd worse = error.col(family) - error.col(than);
  const double mean = (share.array() * worse).sum();
  const double variance = (share.array() * (worse - mean).square()).sum();
  return {mean, std::sqrt(variance / std::max<Eigen::Index>(1, error.rows() - 1))};
}

/// `best`: law of every family, of all blocks; `error`: blocks x families, held back; `share`: of every block.
FrictionChoice chosenOf(const std::vector<Sum>& best, const Eigen::MatrixXd& error, const Eigen::VectorXd& share,
                        const std::vector<FrictionElement>& elements, OthersLaws& others) {
  const Eigen::RowVectorXd mean = share.transpose() * error;
  Eigen::Index least = 0, first = 0, end = kGroupEnds.front();
  Eigen::RowVectorXd eligible = mean;
  for (Eigen::Index f = kOtherSmooth; f < kOtherSmoothEnd; ++f) {
    const Worse than_tanh = worseBy(error, share, f, kTanh);
    if (than_tanh.mean > -kSurelyRare * than_tanh.standard_error) eligible[f] = std::numeric_limits<double>::infinity();
  }
  const double usual = eligible.head(end).minCoeff(&least);
  // One group after the other: a family that is a little better, but less surely, must not take another's place.
  for (std::size_t group = 1; group < kGroupEnds.size(); ++group) {
    const Eigen::Index from = kGroupEnds[group - 1], next = kGroupEnds[group];
    Eigen::Index rare = 0;
    mean.segment(from, next - from).minCoeff(&rare);
    rare += from;
    const Worse worse = worseBy(error, share, rare, least);
    const bool surely = worse.mean < -kSurelyRare * worse.standard_error;
    const Sum& rarest = best[static_cast<std::size_t>(rare)];
    const bool halves = mean[rare] < kHalves * mean[least];
    const double most = group == kGroupOfRamp || relaxes(rarest, elements) ? kWorthALittle
                        : group == kGroupOfRest                            ? 1.0
                                                                           : kWorthALaw;
    const bool taken = (surely && mean[rare] < most * usual) || (halves && most == kWorthALaw);
    if (rarest.which.empty() || !taken) continue;
    least = rare;
    first = from;
    end = next;
  }
  const std::size_t elements_of_best = best[static_cast<std::size_t>(least)].which.size();
  others.best = error.col(least);
  others.share = share;
  FrictionChoice choice;
  bool chosen = false;
  for (Eigen::Index f = 0; f < mean.size(); ++f) {
    const Sum& sum = best[static_cast<std::size_t>(f)];
    if (sum.which.empty()) continue;
    const Worse worse = worseBy(error, share, f, least);
    choice.tried.push_back({lawOf(sum, elements), kFamilyNumbers[static_cast<std::size_t>(f)], mean[f], worse.mean,
                            worse.standard_error, static_cast<int>(f)});
    if (chosen || f < first || f >= end || std::isinf(eligible[f])) continue;
    if (!inPlaceOf(least, elements_of_best, f, worse, mean[f] / mean[least])) continue;
    choice.law = choice.tried.back().law;
    choice.family = static_cast<int>(f);
    chosen = true;
  }
  return choice;
}

/// `laws`: of other actuators, in `elements`.
FrictionChoice chooseFrom(const std::vector<FrictionBlock>& blocks, const Eigen::VectorXd& ridge,
                          const std::vector<FrictionElement>& elements, const FrictionRange& range,
                          const std::vector<Sum>& laws, OthersLaws& others) {
  FrictionBlock everything;
  for (const FrictionBlock& b : blocks)
    everything += b;
  const Eigen::Index families = static_cast<Eigen::Index>(kFamilyNumbers.size());
  Eigen::MatrixXd error(static_cast<Eigen::Index>(blocks.size()), families);
  Eigen::VectorXd share(error.rows());
  others.error.resize(error.rows(), static_cast<Eigen::Index>(laws.size()));
  InWeights training;
  for (Eigen::Index b = 0; b < error.rows(); ++b) {
    const FrictionBlock& out = blocks[static_cast<std::size_t>(b)];
    share[b] = out.rows / everything.rows;
    const FittedBase fitted = eliminateBase(everything.minus(out), ridge, training);
    const std::vector<Sum> best = bestOfFamilies(training, elements, range);
    for (Eigen::Index f = 0; f < families; ++f) {
      const Sum& sum = best[static_cast<std::size_t>(f)];
      error(b, f) = fitted.leftOn(out, sum.which, sum.weights) / std::max(1.0, out.rows);
    }
    for (std::size_t k = 0; k < laws.size(); ++k)
      others.error(b, static_cast<Eigen::Index>(k)) =
          leftByLaw(training, fitted, out, laws[k]) / std::max(1.0, out.rows);
  }
  eliminateBase(everything, ridge, training);
  return chosenOf(bestOfFamilies(training, elements, range), error, share, elements, others);
}

}  // namespace

std::vector<FrictionChoice> chooseFriction(const std::vector<Observation>& training, const ObservationOptions& options,
                                           const std::vector<Column>& columns, const Equations& e,
                                           const Eigen::VectorXd& noise_N, const Reduction& r, double strength,
                                           const std::vector<FrictionRange>& ranges,
                                           const std::vector<FrictionChoice>& around) {
  const Eigen::VectorXd factor = restAsMotion(e, noise_N);
  const Eigen::Index each = e.rows() / e.axes;
  const Eigen::VectorXd weight = rowWeights(e, noise_N, factor);
  InCoordinates all = inCoordinates(e, r, factor);
  const Eigen::MatrixXd beside = besideAt(training, options, e, weight);
  all.x.conservativeResize(Eigen::NoChange, all.x.cols() + beside.cols());
  all.x.rightCols(beside.cols()) = beside;
  std::vector<FrictionChoice> choices(static_cast<std::size_t>(e.axes));
  const std::vector<dynamics::FrictionLaw> shared =
      e.axes > 1 ? sharedLaws(around) : std::vector<dynamics::FrictionLaw>();
  std::vector<OthersLaws> others(static_cast<std::size_t>(e.axes));
  const std::vector<FrictionBlock> base = sumsOfBase(e, all);
  inParallel(choices.size(), [&](std::size_t axis) {
    const int i = static_cast<int>(axis);
    std::vector<FrictionElement> elements = elementsToTry(ranges[axis]);
    if (!around.empty()) addFinerSteps(around[axis], ranges[axis].narrowest_m, elements);
    std::vector<Sum> laws = inElements(shared, elements);
    const int mixing = mixingFirst(elements, laws);
    Eigen::MatrixXd candidates(each, static_cast<Eigen::Index>(elements.size()));
    for (std::size_t from = 0; from < elements.size(); from += kAtOnce) {
      const std::size_t count = std::min(kAtOnce, elements.size() - from);
      candidates.middleCols(static_cast<Eigen::Index>(from), static_cast<Eigen::Index>(count)) =
          atRows(training, options, e, i, sharesOf(training, axis, elements, from, count));
    }
    candidates.array().colwise() *= weight.segment(i * each, each).array();
    Eigen::Index without = -1;  // the coordinate of its own Coulomb friction
    for (std::size_t k = 0; k < r.kept.size(); ++k) {
      const Column& c = columns[static_cast<std::size_t>(r.kept[k])];
      if (c.role == ColumnRole::Coulomb && c.actuator == i) without = static_cast<Eigen::Index>(k);
    }
    Eigen::VectorXd ridge = Eigen::VectorXd::Zero(all.x.cols() - (without >= 0 ? 1 : 0));
    ridge.segment(ridge.size() - beside.cols() - r.directions.cols(), r.directions.cols()).setConstant(strength);
    ridge.tail(beside.cols()).setConstant(kSizeAsFound);
    choices[axis] = chooseFrom(sumsOfBlocks(e, all, base, without, candidates, mixing, i * each), ridge, elements,
                               ranges[axis], laws, others[axis]);
  });
  std::vector<double> narrowest_m;
  for (const FrictionRange& range : ranges)
    narrowest_m.push_back(range.narrowest_m);
  shareFamily(choices);
  shareLaw(shared, others, narrowest_m, choices);
  return choices;
}

}  // namespace knee_robot::identification
