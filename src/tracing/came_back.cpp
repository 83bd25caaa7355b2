#include "came_back.h"

#include <algorithm>
#include <cmath>

#include "stretches.h"

namespace knee_robot::tracing {
namespace {

constexpr double kSamePlace = 0.01;  ///< of the way that an actuator has in the recordings
constexpr double kApart_s = 1.0;     ///< from the push: nearer samples are the same passage
constexpr Eigen::Index kFewest = 3;  ///< samples elsewhere that tell what is left at a place
constexpr double kLeastTold = 0.5;   ///< share of the push's samples of which something is told elsewhere

/// A sample at which the loaded actuator moves.
struct Passage {
  double position_m = 0.0, left_N = 0.0;
  bool forward = false;
};

/// Passages with the samples during the push, and others far from it.
struct Passages {
  std::vector<Passage> during, otherwise;
};

Passages passagesOf(const Search& s, const Hypothesis& push, const Eigen::VectorXd& left_N, int loaded,
                    const Eigen::VectorXd& along_m) {
  const Stack& stack = s.data->stack;
  const std::size_t recording = static_cast<std::size_t>(push.shape[0]) - 1;
  const double from_s = push.shape[1], to_s = from_s + push.shape[2];
  Passages out;
  for (Eigen::Index n = 0; n < stack.size(); ++n) {
    const Pick& pick = stack.picks[static_cast<std::size_t>(n)];
    const identification::Observation& observed = s.data->recordings[pick.recording];
    if (!observed.axis_moving(pick.sample, loaded)) continue;
    const Passage passage = {along_m[n], left_N[loaded * stack.size() + n],
                             observed.signals.velocity_m_per_s(pick.sample, loaded) > 0.0};
    const double time = s.data->inputs[pick.recording].time(pick.sample);
    if (pick.recording == recording && time >= from_s && time <= to_s)
      out.during.push_back(passage);
    else if (pick.recording != recording || time < from_s - kApart_s || time > to_s + kApart_s)
      out.otherwise.push_back(passage);
  }
  return out;
}

Recurrence compare(const Passages& passages, double width_m) {
  double square = 0.0, missed = 0.0, covered = 0.0, told = 0.0;
  for (const Passage& own : passages.during) {
    double sum = 0.0;
    Eigen::Index same_way = 0, any_way = 0;
    for (const Passage& other : passages.otherwise) {
      if (std::abs(other.position_m - own.position_m) > width_m) continue;
      ++any_way;
      if (other.forward != own.forward) continue;
      sum += other.left_N;
      ++same_way;
    }
    if (any_way >= kFewest) ++covered;
    if (same_way < kFewest) continue;
    ++told;
    square += own.left_N * own.left_N;
    missed += std::pow(own.left_N - sum / static_cast<double>(same_way), 2);
  }
  const double all = static_cast<double>(passages.during.size());
  Recurrence out;
  if (all > 0.0) out.covered = covered / all;
  if (told >= kLeastTold * all && square > 0.0) out.share = 1.0 - missed / square;
  return out;
}

/// Squares of a stacked vector, actuator by actuator.
Eigen::VectorXd squaresOf(const Stack& stack, const Eigen::VectorXd& stacked) {
  return Eigen::Map<const Eigen::MatrixXd>(stacked.data(), stack.size(), stack.axes).colwise().squaredNorm();
}

}  // namespace

Recurrence recurrenceOf(const Search& s, const Hypothesis& push, const Eigen::VectorXd& without_N) {
  const Stack& stack = s.data->stack;
  const Eigen::VectorXd acts = (effectRows(*s.data, push).rowwise().squaredNorm().array() > 0.0).cast<double>();
  int loaded = 0;
  squaresOf(stack, without_N.cwiseProduct(acts)).maxCoeff(&loaded);
  const Eigen::MatrixXd positions = positionsOf(s.data->recordings, stack);
  Recurrence out;
  for (Eigen::Index other = 0; other < positions.cols(); ++other) {
    const Eigen::VectorXd along = positions.col(other);
    const Recurrence own =
        compare(passagesOf(s, push, without_N, loaded, along), kSamePlace * (along.maxCoeff() - along.minCoeff()));
    out.share = std::max(out.share, own.share);
    out.covered = std::min(out.covered, own.covered);
  }
  return out;
}

double shareOfOneActuator(const Search& s, const Hypothesis& push, const Eigen::VectorXd& coefficients) {
  const Eigen::VectorXd squares = squaresOf(s.data->stack, effectRows(*s.data, push) * coefficients);
  return squares.maxCoeff() / std::max(1e-300, squares.sum());
}

}  // namespace knee_robot::tracing
