#include "search.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "decide.h"
#include "doubt.h"
#include "knee_robot/base/parallel.h"
#include "near_rest.h"
#include "refine.h"
#include "refit.h"
#include "replace_kin.h"
#include "replace_pair.h"
#include "rivals.h"
#include "settle_heat.h"
#include "settle_rest_law.h"
#include "trial.h"

namespace knee_robot::tracing {
namespace {

constexpr double kLargestP = 0.005;
constexpr double kSiblingP = 0.01;     ///< of the same effect on another actuator
constexpr double kWorthwhile = 0.4;    ///< lowering the rms by a tenth explains 0.44 of it; less is never accepted
constexpr double kSiblingWorth = 0.2;  ///< lowering it by three hundredths explains 0.24
constexpr double kLeastSpread = 0.01;  ///< of a place's null values: absorbed places have none
constexpr double kDiscount = 0.8;      ///< a map must explain this much more than a named effect to be preferred
constexpr double kAboveFloor = 1.15;   ///< is more than noise
constexpr double kAnotherKind = 0.9;   ///< as another ripple must than a further period of what ripples already

/// Sum of the held-back gains by which trials are ranked; of maps and generalizations what they surely gain, because
/// they bend to much.
double worth(const Trial& t) {
  const double n = static_cast<double>(t.nested_gain.size());
  const HeldBackGain g = heldBackGain(t.nested_gain);
  const bool bends = t.isMap() || !t.hypothesis.place.candidate->generalizes().empty();
  const bool further = t.hypothesis.place.order > 0;
  return n * (bends ? kDiscount * g.mean - g.error : further ? g.mean / kAnotherKind : g.mean);
}

/// Roots of the shares that the best shape of every place (rows; only those with a row number) explains of residuals
/// (columns).
Eigen::MatrixXd rootsOf(const Search& s, const Projection& projection, const std::map<std::size_t, Eigen::Index>& row,
                        const Eigen::MatrixXd& residuals) {
  Eigen::MatrixXd roots(static_cast<Eigen::Index>(row.size()), residuals.cols());
  std::vector<std::pair<std::size_t, Eigen::Index>> list(row.begin(), row.end());
  inParallel(list.size(), [&](std::size_t k) {
    const PlaceColumns& p = s.library->places()[list[k].first];
    const Eigen::MatrixXd squares =
        explained(makeProbes(*s.data, p.tried, p.rows, p.first_row, projection, s.rms_N), residuals);
    roots.row(list[k].second) =
        (squares.colwise().maxCoeff().cwiseMax(0.0) / static_cast<double>(s.data->stack.size())).cwiseSqrt();
  });
  return roots;
}

/// The residual of the forces.
class ForceSelection : public SelectionProblem {
 public:
  /// `like`: what was found, of which the other actuators are asked; null: everything is.
  ForceSelection(Search& search, std::uint64_t seed, const Place* like) : s_(search), seed_(seed), like_(like) {}

  std::vector<SelectionTrial> compare() override {
    trials_.clear();
    if (like_ == nullptr ? !exceedsFloor(s_) : (s_.rms_N.array() <= s_.floor.rms_N.array()).all()) return {};
    Ranking r = rankPlaces(s_, like_);
    projection_ = std::move(r.projection);
    trials_ = std::move(r.trials);
    std::stable_sort(trials_.begin(), trials_.end(),
                     [](const Trial& a, const Trial& b) { return worth(a) > worth(b); });
    row_.clear();
    for (std::size_t k = 0; k < s_.library->places().size(); ++k) {
      if (!openPlace(s_, s_.library->places()[k].place(), like_)) continue;
      const Eigen::Index next = static_cast<Eigen::Index>(row_.size());
      row_[k] = next;
    }
    std::vector<SelectionTrial> out;
    for (const Trial& t : trials_)
      out.push_back({row_.at(t.place), std::sqrt(std::max(0.0, t.share)), placeText(t.hypothesis.place),
                     objection(s_, t, like_ != nullptr)});
    return out;
  }

  /// What the best hypothesis leaves is the noise: the effect itself is none.
  MaxNull null() override {
    s_.options->progress("comparing with surrogates");
    const auto best = std::find_if(trials_.begin(), trials_.end(),
                                   [&](const Trial& t) { return objection(s_, t, like_ != nullptr).empty(); });
    const Eigen::MatrixXd residuals = nullResiduals(s_.surrogates, *s_.data, best->fit.residual_N, s_.rms_N,
                                                    projection_, s_.options->draws, seed_ + s_.effects.size());
    return maxNull(rootsOf(s_, projection_, row_, residuals), like_ != nullptr ? kSiblingWorth : kWorthwhile,
                   kLeastSpread);
  }

  bool accept(std::size_t k, const MaxNull& null, double p) override {
    const Trial& t = trials_[k];
    FoundEffect e;
    e.hypothesis = t.hypothesis;
    e.p = p;
    const Eigen::VectorXd after = rmsOf(s_.data->stack, t.fit.residual_N);
    e.explained_rms_N = (s_.rms_N.cwiseAbs2() - after.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
    e.null_rms_N = null.threshold(row_.at(t.place)) * s_.rms_N;
    const double blocks = static_cast<double>(t.gain.size()), total = s_.fit.held_back.sum();
    e.gain = t.held.mean * blocks / total;
    e.gain_error = t.held.error * blocks / total;
    e.indistinguishable_from = rivalsOf(s_, t, trials_, like_ != nullptr, e.probability);
    const auto& rivals = e.indistinguishable_from;
    e.doubted = e.probability < kEven && std::find(rivals.begin(), rivals.end(), "unnamed") != rivals.end();
    const std::size_t before = s_.effects.size();
    s_.effects.push_back(e);
    s_.options->progress("found " + placeText(e.hypothesis.place));
    refit(s_);
    if (like_ != nullptr) return true;
    followSiblings(e.hypothesis.place);
    standAlone(s_, e.hypothesis.place);
    replaceKin(s_, e.hypothesis.place);
    nameMatrix(s_, e.hypothesis.place);
    refineShapes(s_);
    replacePair(s_, e.hypothesis.place.candidate);
    simplify(s_);
    replaceMaps(s_);
    eliminateBackward(s_);
    (void)settleHeat(s_, e.hypothesis.place.candidate);  // before something else stands for what the clock misses
    bool other_law = settleRestLaw(s_, e.hypothesis.place.candidate);
    if (rebase(s_)) other_law = true;
    s_.library->update(*s_.data, other_law);
    if (other_law) updateNearRest(s_);
    s_.options->progress("simulating surrogates that have what was found");
    s_.rebuild_surrogates();
    return s_.effects.size() > before;
  }

 private:
  /// What is found on one actuator is often on the others, weaker.
  void followSiblings(const Place& found) {
    if (found.candidate->shared()) return;
    std::vector<std::string> rejected;
    ForceSelection others(s_, seed_ + 7u, &found);
    selectForward(others, s_.data->stack.axes - 1, kSiblingP, rejected);
    inheritDoubt(found);
  }

  /// They were asked for this name alone: it is no surer on them than where it was found.
  void inheritDoubt(const Place& found) {
    const auto first =
        std::find_if(s_.effects.begin(), s_.effects.end(), [&](const auto& e) { return e.hypothesis.place == found; });
    if (first == s_.effects.end() || !first->doubted) return;
    for (FoundEffect& e : s_.effects) {
      const bool given = std::isnan(e.p);
      if (given || e.hypothesis.place.candidate != found.candidate || e.probability <= first->probability) continue;
      e.probability = first->probability;
      e.doubted = true;
      e.indistinguishable_from = first->indistinguishable_from;
    }
  }

  Search& s_;
  std::uint64_t seed_;
  const Place* like_;
  Projection projection_;
  std::vector<Trial> trials_;
  std::map<std::size_t, Eigen::Index> row_;  ///< of the null, by place of the library
};

}  // namespace

std::string placeText(const Place& p) {
  const std::string what =
      p.candidate->isMap() ? "unnamed (" + p.candidate->dependsOn(std::max(0, p.actuator)) + ")" : p.candidate->name();
  return what + (p.actuator < 0 ? " (all actuators)" : " on actuator " + std::to_string(p.actuator + 1)) +
         (p.order > 0 ? ", period " + std::to_string(p.order + 1) : "");
}

bool exceedsFloor(const Search& s) {
  return (s.rms_N.array() > kAboveFloor * s.floor.rms_N.array()).any();
}

void searchForward(Search& s, int most, std::uint64_t seed) {
  ForceSelection selection(s, seed, nullptr);
  selectForward(selection, most, kLargestP, s.rejected);
}

}  // namespace knee_robot::tracing
