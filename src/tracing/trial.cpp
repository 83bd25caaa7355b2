#include "trial.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "came_back.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/parallel.h"
#include "near_rest.h"
#include "refit.h"
#include "ripple_periods.h"
#include "whole_size.h"

namespace knee_robot::tracing {
namespace {

constexpr std::size_t kCompared =
    8;                         ///< places that are refined and cross-validated in every pass: named ones, and maps
constexpr int kOfOneKind = 2;  ///< of the same candidate at most: delays of four axes would leave no room for others
constexpr std::size_t kNested = 8;  ///< shapes among which held-back blocks choose
constexpr std::size_t kStarts =
    5;  ///< shapes of an effect between two points from which is refined: it has several hills
constexpr int kTrialRounds = 5;
constexpr double kSlightPull = 1e-6;
constexpr double kMapPull = 1e-3;       ///< hat functions add up to columns that the model has already
constexpr double kMostComesBack = 0.5;  ///< of the squares that a push explains
constexpr int kLocalPieces = 6;         ///< of a local effect that are held back in turn
constexpr double kMostBlocks = 0.5;     ///< share of held-back blocks that must gain
constexpr double kAboveFloor = 1.15;
constexpr double kSiblingAboveFloor = 1.0;
constexpr double kLowered = 0.9;         ///< the rms of some actuator must fall below this share
constexpr double kNearRestFloors = 2.0;  ///< noise floors of an effect that acts near rest, there
constexpr double kNearRestErrors =
    5.0;  ///< standard errors by which such an effect must help, and every block must gain
constexpr double kSiblingLowered = 0.97;  ///< where the same effect was found on another actuator
constexpr int kCarriers = 2;              ///< of the same name, where it is expected on the others, too
constexpr double kSiblingErrors = 2.0;
constexpr double kLagKnownTo = 0.1;  ///< share of how late the forces are read (lead_test: 48.7 ms of 50)

/// Which picks are held back together: the stack's blocks; of a local effect, pieces of the part in which it acts (-1:
/// outside).
std::vector<int> heldTogether(const Stack& stack, const Eigen::MatrixXd& columns, bool local, int& count) {
  std::vector<int> block(static_cast<std::size_t>(stack.size()), -1);
  count = local ? kLocalPieces : stack.blocks;
  std::vector<std::size_t> inside;
  for (std::size_t n = 0; n < block.size(); ++n) {
    block[n] = local ? -1 : stack.picks[n].block;
    bool acts = false;
    for (int i = 0; i < stack.axes && !acts; ++i)
      acts = columns.row(i * stack.size() + static_cast<Eigen::Index>(n)).squaredNorm() > 0.0;
    if (acts) inside.push_back(n);
  }
  for (std::size_t k = 0; local && k < inside.size(); ++k)
    block[inside[k]] = static_cast<int>(k * kLocalPieces / inside.size());
  return block;
}

/// Normal equations of one shape's columns beside the model, block by block; the last are never held back.
struct BlockEquations {
  std::vector<Eigen::MatrixXd> gram;
  Eigen::MatrixXd image, whole_gram;
  Eigen::VectorXd whole_image;
};

BlockEquations blockEquations(const Search& s, const Projection& projection, const Hypothesis& h, int& blocks) {
  const Stack& stack = s.data->stack;
  Eigen::MatrixXd c = weighted(stack, effectRows(*s.data, h), s.rms_N);
  const std::vector<int> together = heldTogether(stack, c, h.place.candidate->local(), blocks);
  c -= projection.q * (projection.q.transpose() * c).eval();
  const Eigen::Index k = c.cols();
  BlockEquations e;
  e.gram.assign(static_cast<std::size_t>(blocks) + 1, Eigen::MatrixXd::Zero(k, k));
  e.image = Eigen::MatrixXd::Zero(k, blocks + 1);
  for (int i = 0; i < stack.axes; ++i) {
    for (Eigen::Index n = 0; n < stack.size(); ++n) {
      const auto row = c.row(i * stack.size() + n);
      const int own = together[static_cast<std::size_t>(n)], block = own < 0 ? blocks : own;
      e.gram[static_cast<std::size_t>(block)].noalias() += row.transpose() * row;
      e.image.col(block) += row.transpose() * projection.residual[i * stack.size() + n];
    }
  }
  e.whole_gram = Eigen::MatrixXd::Zero(k, k);
  for (const Eigen::MatrixXd& own : e.gram)
    e.whole_gram += own;
  const double pull = h.place.candidate->isMap() ? kMapPull : kSlightPull;
  e.whole_gram += pull * Eigen::MatrixXd(e.whole_gram.diagonal().asDiagonal());
  e.whole_image = e.image.rowwise().sum();
  return e;
}

double shareOf(const Search& s, const Projection& projection, const Hypothesis& h) {
  return explained(*s.data, h, projection, s.rms_N) / static_cast<double>(s.data->stack.size());
}

/// Narrows the shape down between its neighbours on the grid.
void refineShape(const Search& s, const Projection& projection, const std::vector<Hypothesis>& tried, Trial& t) {
  const auto attempt = [&](const std::vector<double>& shape) {
    const Hypothesis h = {t.hypothesis.place, shape};
    const double share = shareOf(s, projection, h);
    if (share <= t.share) return;
    t.share = share;
    t.hypothesis = h;
  };
  if (t.hypothesis.shape.size() != 1) {
    double step = 1.0;
    for (int round = 0; round < kTrialRounds; ++round, step *= 0.6) {
      for (const std::vector<double>& shape : t.hypothesis.place.candidate->near(t.hypothesis.shape, step))
        attempt(shape);
    }
    return;
  }
  double low = 0.0, high = std::numeric_limits<double>::infinity();
  const double at = t.hypothesis.shape[0];
  for (const Hypothesis& h : tried) {
    if (h.shape[0] < at) low = std::max(low, h.shape[0]);
    if (h.shape[0] > at) high = std::min(high, h.shape[0]);
  }
  double step = std::min(low > 0.0 ? at / low : 1e9, std::isfinite(high) ? high / at : 1e9);
  if (!(step < 1e9)) return;
  for (int round = 0; round < 4; ++round) {
    step = std::sqrt(step);
    const double center = t.hypothesis.shape[0];
    attempt({center / step});
    attempt({center * step});
  }
}

void takeWhole(const Search& s, const Projection& projection, Trial& t) {
  t.hypothesis = ofWholeSize(s, projection, t.hypothesis);
  t.share = shareOf(s, projection, t.hypothesis);
}

/// Best shapes of a place on the grid, best first.
std::vector<Hypothesis> bestShapes(const PlaceColumns& place, const Eigen::VectorXd& squares) {
  std::vector<std::size_t> order(place.tried.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    order[k] = k;
  const std::size_t count = std::min(order.size(), kNested);
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
                    [&](std::size_t a, std::size_t b) {
                      return squares[static_cast<Eigen::Index>(a)] > squares[static_cast<Eigen::Index>(b)];
                    });
  std::vector<Hypothesis> out;
  for (std::size_t k = 0; k < count; ++k)
    out.push_back(place.tried[order[k]]);
  return out;
}

/// `rows`: of the effects found so far.
void crossValidate(const Search& s, const Projection& projection, std::vector<Eigen::MatrixXd> rows,
                   std::vector<Hypothesis> shapes, Trial& t) {
  std::vector<Hypothesis> all = hypothesesOf(s.effects);
  all.push_back(t.hypothesis);
  rows.push_back(effectRows(*s.data, t.hypothesis));
  t.fit = JointProblem(*s.data, *s.base, s.rms_N, all, std::move(rows)).fit();
  t.joint_gain = s.fit.held_back - t.fit.held_back;
  if (t.hypothesis.place.candidate->local()) shapes.clear();
  shapes.push_back(t.hypothesis);
  t.nested_gain = nestedGain(s, projection, shapes);
  const HeldBackGain joint = heldBackGain(t.joint_gain), nested = heldBackGain(t.nested_gain);
  t.by_joint = !t.hypothesis.place.candidate->local() && joint.mean * nested.error >= nested.mean * joint.error;
  t.gain = t.by_joint ? t.joint_gain : t.nested_gain;
  t.held = t.by_joint ? joint : nested;
}

std::string sizeText(const Search& s, const Trial& t) {
  const std::vector<Coefficient> names = t.hypothesis.place.candidate->coefficients(s.data->inputs.front());
  std::string out;
  for (std::size_t k = 0; k < names.size(); ++k)
    out += (k == 0 ? "" : ", ") + names[k].name + " = " +
           shortNumber(t.fit.coefficients.back()[static_cast<Eigen::Index>(k)], 3);
  return out;
}

/// Large where it acts and sure beyond doubt, if small in a brisk training: a slow motion is made of it.
bool isLargeNearRest(const Search& s, const Trial& t) {
  if (!t.hypothesis.place.candidate->actsNearRest()) return false;
  const double size_N = t.fit.coefficients.back().cwiseAbs().maxCoeff();
  const double floor_N = s.floor.of_names_N[t.hypothesis.place.actuator];
  if (s.rms_N[t.hypothesis.place.actuator] <= floor_N) return false;  // nothing is left there to be explained
  return size_N > kNearRestFloors * floor_N && t.held.gaining == 1.0 && t.held.mean > kNearRestErrors * t.held.error;
}

/// On several others already, and the floor that it would have to exceed is an estimate, which may be far too high.
bool isExpected(const Search& s, const Trial& t) {
  const auto carriers = std::count_if(s.effects.begin(), s.effects.end(), [&](const FoundEffect& e) {
    return e.hypothesis.place.candidate == t.hypothesis.place.candidate;
  });
  return !s.floor.measured && carriers >= kCarriers;
}

}  // namespace

Eigen::VectorXd nestedGain(const Search& s, const Projection& projection, const std::vector<Hypothesis>& shapes) {
  int blocks = 0;
  std::vector<BlockEquations> all;
  for (const Hypothesis& h : shapes)
    all.push_back(blockEquations(s, projection, h, blocks));
  Eigen::VectorXd gain = Eigen::VectorXd::Zero(blocks);
  for (int b = 0; b < blocks; ++b) {
    double most = -std::numeric_limits<double>::infinity();
    for (const BlockEquations& e : all) {
      const Eigen::MatrixXd& own = e.gram[static_cast<std::size_t>(b)];
      const Eigen::VectorXd right = e.whole_image - e.image.col(b);
      const Eigen::VectorXd theta = (e.whole_gram - own).ldlt().solve(right);
      if (theta.dot(right) <= most) continue;
      most = theta.dot(right);
      gain[b] = 2.0 * theta.dot(e.image.col(b)) - theta.dot(own * theta);
    }
  }
  return gain;
}

std::optional<Place> openPlace(const Search& s, const Place& place, const Place* like) {
  if (!s.maps && place.candidate->isMap()) return {};
  if (place.candidate->needsTwoRecordings() && s.data->recordings.size() < 2) return {};
  if (std::find(s.absorbed.begin(), s.absorbed.end(), place) != s.absorbed.end()) return {};
  const bool leads = std::any_of(s.effects.begin(), s.effects.end(), [&](const FoundEffect& e) {
    return e.hypothesis.place.candidate->leads() && e.hypothesis.place.actuator == place.actuator;
  });
  if (leads && place.candidate->leads()) return {};  // dead time and lag: one of them
  const auto taken = [&](const Place& p) {
    return std::any_of(s.effects.begin(), s.effects.end(),
                       [&](const FoundEffect& e) { return e.hypothesis.place == p; });
  };
  Place open = place;
  while (taken(open))
    ++open.order;
  if (open.order >= place.candidate->mostOnOneActuator()) return {};
  if (like != nullptr && (like->candidate != place.candidate || like->order != open.order)) return {};
  return open;
}

Ranking rankPlaces(Search& s, const Place* like) {
  const std::vector<Hypothesis> accepted = hypothesesOf(s.effects);
  const std::vector<Eigen::MatrixXd> accepted_rows = effectRows(*s.data, accepted);
  s.fit = JointProblem(*s.data, *s.base, s.rms_N, accepted, accepted_rows).fit();
  Ranking r;
  r.projection = projectModel(s, accepted);
  const std::vector<PlaceColumns>& places = s.library->places();
  std::vector<Eigen::VectorXd> squares(places.size());
  inParallel(places.size(), [&](std::size_t k) {
    const PlaceColumns& p = places[k];
    if (!openPlace(s, p.place(), like)) return;
    squares[k] =
        explained(makeProbes(*s.data, p.tried, p.rows, p.first_row, r.projection, s.rms_N), r.projection.residual);
  });
  std::vector<Trial> trials[2];  // named, maps
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (squares[k].size() == 0) continue;
    Trial t;
    t.place = k;
    Eigen::Index at = 0;
    t.share = squares[k].maxCoeff(&at) / static_cast<double>(s.data->stack.size());
    t.hypothesis = places[k].tried[static_cast<std::size_t>(at)];
    t.hypothesis.place = *openPlace(s, places[k].place(), like);
    trials[t.isMap()].push_back(std::move(t));
  }
  for (std::vector<Trial>& list : trials) {
    std::sort(list.begin(), list.end(), [](const Trial& a, const Trial& b) { return a.share > b.share; });
    std::map<const Candidate*, int> taken;
    std::size_t kept = 0;
    for (Trial& t : list) {
      if (kept >= kCompared || (like == nullptr && ++taken[t.hypothesis.place.candidate] > kOfOneKind)) continue;
      ++kept;
      r.trials.push_back(std::move(t));
    }
  }
  inParallel(r.trials.size(), [&](std::size_t k) {
    Trial& t = r.trials[k];
    const std::vector<Hypothesis> starts = bestShapes(places[t.place], squares[t.place]);
    refineShape(s, r.projection, places[t.place].tried, t);
    takeWhole(s, r.projection, t);
    for (std::size_t from = 1; t.hypothesis.place.actuator < 0 && from < std::min(kStarts, starts.size()); ++from) {
      Trial other = t;
      other.hypothesis = starts[from];
      other.share = shareOf(s, r.projection, starts[from]);
      refineShape(s, r.projection, places[t.place].tried, other);
      takeWhole(s, r.projection, other);
      if (other.share > t.share) t = other;
    }
    crossValidate(s, r.projection, accepted_rows, starts, t);
  });
  std::sort(r.trials.begin(), r.trials.end(),
            [](const Trial& a, const Trial& b) { return a.nested_gain.sum() > b.nested_gain.sum(); });
  return r;
}

/// A drive is late by less than the error with which it is known how late all forces are read.
bool isWithinALag(const Search& s, const Trial& t) {
  if (!t.hypothesis.place.candidate->leads()) return false;
  return std::any_of(s.effects.begin(), s.effects.end(), [&](const FoundEffect& e) {
    return e.hypothesis.place.candidate->lags() &&
           std::abs(t.fit.coefficients.back()[0]) < kLagKnownTo * std::abs(e.coefficients[0]);
  });
}

/// A filter of the forces smooths what dry friction does where an axis turns: the remainder looks like a friction.
bool isWhatAFilterLeaves(const Search& s, const Trial& t) {
  return t.hypothesis.place.candidate->actsNearRest() && !t.isMap() &&
         std::any_of(s.effects.begin(), s.effects.end(),
                     [](const FoundEffect& e) { return e.hypothesis.place.candidate->lags(); });
}

std::string objection(const Search& s, const Trial& t, bool sibling) {
  const Eigen::VectorXd rms = rmsOf(s.data->stack, t.fit.residual_N);
  const double lowered = sibling ? kSiblingLowered : kLowered;
  const double above = sibling ? kSiblingAboveFloor : kAboveFloor;
  const bool expected = sibling && isExpected(s, t);
  bool worth_it = false;
  for (int i = 0; i < rms.size(); ++i) {
    if (t.hypothesis.place.actuator >= 0 && t.hypothesis.place.actuator != i) continue;
    worth_it = worth_it || ((expected || s.rms_N[i] > above * s.floor.rms_N[i]) && rms[i] < lowered * s.rms_N[i]);
  }
  const bool near_rest = isLargeNearRest(s, t);
  if (!worth_it && !near_rest) return "does not lower the residual by a tenth where it is above the floor";
  const double least = near_rest ? 1.0 - kSiblingLowered * kSiblingLowered : 1.0 - lowered * lowered;
  if (periodCoincides(s, t.hypothesis)) return "its period cannot be told from that of another on this actuator";
  const bool rubs = t.hypothesis.place.candidate->isFriction() && t.hypothesis.place.actuator >= 0 && !t.isMap();
  if (t.share < least && !(rubs && shareBeyondLaws(s, t.hypothesis) >= least))
    return "another law of friction near rest explains most of the same";
  if (!t.hypothesis.place.candidate->plausibleShape(t.hypothesis.shape)) return "the shape that fits is not physical";
  if (t.fit.coefficients.back().cwiseAbs().maxCoeff() == 0.0) return "the sign that fits is not physical";
  if (!t.hypothesis.place.candidate->plausible(t.fit.coefficients.back()))
    return "the size that fits is not physical (" + sizeText(s, t) + ")";
  if (isWhatAFilterLeaves(s, t)) return "the forces are read late, which leaves the same where an axis turns";
  if (isWithinALag(s, t)) return "it is less than a tenth of how late the forces are read, which is known no better";
  if (!t.fit.stable.back()) return "its sign changes when a part of the training data is left out";
  if (t.hypothesis.place.candidate->local()) {  // few pieces, some of them with little motion: their number speaks
    const Eigen::VectorXd without = t.fit.residual_N + effectRows(*s.data, t.hypothesis) * t.fit.coefficients.back();
    const double back = recurrenceOf(s, t.hypothesis, without).share;
    if (back > kMostComesBack)
      return "what it would be comes back at the same places at other times (" + shortNumber(100.0 * back, 2) +
             " % of it)";
    if (t.held.gaining >= kMostPieces && t.held.mean > t.held.error) return {};
    return "does not help on held-back pieces of the time in which it acts (" + shortNumber(100.0 * t.held.gaining, 3) +
           " % of them gain)";
  }
  const double errors = t.isMap() ? kMapErrors : sibling ? kSiblingErrors : 1.0;
  const HeldBackGain joint = heldBackGain(t.joint_gain), nested = heldBackGain(t.nested_gain);
  const bool together = joint.mean > errors * joint.error && nested.mean > nested.error && joint.gaining >= kMostBlocks;
  const bool alone = nested.mean > (errors + 1.0) * nested.error && nested.gaining >= kMostBlocks;
  if (!together && !alone)
    return "does not help on held-back parts of the training data (mean " + shortNumber(t.held.mean, 3) + " +- " +
           shortNumber(t.held.error, 3) + ", " + shortNumber(100.0 * t.held.gaining, 3) + " % of them gain)";
  return {};
}

}  // namespace knee_robot::tracing
