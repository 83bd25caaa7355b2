#include "places.h"

#include <cmath>
#include <unordered_map>

namespace knee_robot::identification {
namespace {

constexpr double kNewPlace = 0.1;  ///< of a coordinate's standard deviation: farther from all known places is a new one
constexpr double kSamePlace = 0.2;     ///< nearer than this, on another visit, counts as the same
constexpr double kLeastSpread = 0.01;  ///< of the largest spread of a position (velocity): an axis that hardly moves
constexpr int kOtherVisit = 20;        ///< samples: a place this much older was not left just now

/// Every coordinate in units of its spread, single precision: distances are compared with a tenth.
Eigen::MatrixXf inSpreads(const Eigen::MatrixXd& state) {
  const Eigen::Index axes = state.cols() / 2;
  const Eigen::MatrixXd centred = state.rowwise() - state.colwise().mean();
  Eigen::RowVectorXd spread = (centred.colwise().squaredNorm() / static_cast<double>(state.rows())).cwiseSqrt();
  for (const Eigen::Index first : {Eigen::Index{0}, axes}) {
    const double least = std::max(kLeastSpread * spread.segment(first, axes).maxCoeff(), 1e-12);
    spread.segment(first, axes) = spread.segment(first, axes).cwiseMax(least);
  }
  // A place a column: neighbours are compared coordinate by coordinate.
  return (centred.array().rowwise() / spread.array()).matrix().transpose().cast<float>();
}

/// Places found so far, in slices of the first coordinate that are as wide as the search reaches.
class Places {
 public:
  explicit Places(const Eigen::MatrixXf& state) : state_(state) {}

  /// The nearest place within kSamePlace, -1 if there is none, and its distance (largest difference of a coordinate).
  int nearest(int sample, float& distance) const {
    int found = -1;
    distance = static_cast<float>(kSamePlace);
    for (int slice = sliceOf(sample) - 1; slice <= sliceOf(sample) + 1; ++slice) {
      const auto list = slices_.find(slice);
      if (list == slices_.end()) continue;
      for (const int place : list->second) {
        float away = 0.0F;
        for (Eigen::Index c = 0; c < state_.rows() && away < distance; ++c)
          away = std::max(away, std::abs(state_(c, sample) - state_(c, place)));
        if (away >= distance) continue;
        distance = away;
        found = place;
      }
    }
    return found;
  }

  void add(int sample) { slices_[sliceOf(sample)].push_back(sample); }

 private:
  int sliceOf(int sample) const { return static_cast<int>(std::floor(state_(0, sample) / kSamePlace)); }

  const Eigen::MatrixXf& state_;
  std::unordered_map<int, std::vector<int>> slices_;
};

}  // namespace

std::vector<int> firstVisits(const Eigen::MatrixXd& state, const std::vector<int>& run) {
  const Eigen::MatrixXf scaled = inSpreads(state);
  Places places(scaled);
  std::vector<int> first(run.size());
  for (int k = 0; k < static_cast<int>(run.size()); ++k) {
    const std::size_t here = static_cast<std::size_t>(k);
    float distance = 0.0F;
    const int place = places.nearest(k, distance);
    const bool other_visit = place >= 0 && k - place > kOtherVisit;
    first[here] = k;
    if (place >= 0 && (distance <= kNewPlace || other_visit)) {
      const int origin = first[static_cast<std::size_t>(place)];
      if (run[static_cast<std::size_t>(origin)] != run[here]) first[here] = origin;
    }
    if (place < 0 || distance > kNewPlace) places.add(k);
  }
  return first;
}

}  // namespace knee_robot::identification
