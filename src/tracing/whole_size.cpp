#include "whole_size.h"

#include <cmath>

namespace knee_robot::tracing {
namespace {

constexpr int kSteps = 4;
constexpr double kNearlyOne = 0.1;
constexpr double kNearlyAsMuch = 0.9;  ///< of the squares that the shape with another size explains

}  // namespace

Hypothesis ofWholeSize(const Search& s, const Projection& projection, const Hypothesis& hypothesis) {
  const Candidate& candidate = *hypothesis.place.candidate;
  if (candidate.ofSize(hypothesis.shape, 1.0).empty()) return hypothesis;
  Hypothesis now = hypothesis;
  double first = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const Probes probes = makeProbes(*s.data, {now}, projection, s.rms_N);
    const double squares = explained(probes, projection.residual)(0, 0);
    if (k == 0) first = squares;
    if (!(squares > 0.0) || squares < kNearlyAsMuch * first) return hypothesis;
    const double share = probes.inverse[0](0, 0) * probes.columns.col(0).dot(projection.residual.segment(
                                                       probes.first_row, probes.columns.rows()));
    if (std::abs(share - 1.0) < kNearlyOne) return now;
    now.shape = candidate.ofSize(now.shape, share);
  }
  return now;
}

}  // namespace knee_robot::tracing
