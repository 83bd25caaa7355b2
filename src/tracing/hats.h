#pragma once

#include <Eigen/Core>
#include <vector>

#include "knee_robot/tracing/candidate.h"

namespace knee_robot::tracing {

/// Of a map over one signal: a piecewise linear function is a sum of so many hats.
inline constexpr int kKnots = 8;

/// The function's value at every knot in turn one, at the others zero, along a signal: samples x knots. Constant beyond
/// the outer knots.
Eigen::MatrixXd hats(const Eigen::VectorXd& signal, const std::vector<double>& knots);

/// Between what nearly all values lie.
struct Range {
  double low = 0.0, high = 0.0;
  bool varies() const { return high - low > 1e-9; }
};
/// Sorts the values.
Range rangeOf(std::vector<double>& values);

/// Half by equal shares of the values, so that they are apart even where the signal rests. `history`: those by equal
/// factors.
std::vector<double> evenKnots(const std::vector<double>& sorted, const Range& range, bool history, int count = kKnots);
/// Close to zero, where what rubs, or is lost in a drive, changes its sign. The range has both signs.
std::vector<double> knotsAtZero(const Range& range);

/// knot_1 ...: chosen by the recordings.
std::vector<ShapeParameter> knotParameters(int count = kKnots);
/// force_at_knot_1_N ...
std::vector<Coefficient> knotCoefficients(const std::string& what, const std::string& unit, int count = kKnots);

}  // namespace knee_robot::tracing
