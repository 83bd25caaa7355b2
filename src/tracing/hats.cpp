#include "hats.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace knee_robot::tracing {
namespace {

constexpr double kEvenShare = 0.5;  ///< by signal, the rest by number of samples
constexpr double kHistoryRange = 100.0;

}  // namespace

Eigen::MatrixXd hats(const Eigen::VectorXd& signal, const std::vector<double>& knots) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(signal.size(), static_cast<Eigen::Index>(knots.size()));
  for (Eigen::Index n = 0; n < signal.size(); ++n) {
    const double at = std::clamp(signal[n], knots.front(), knots.back());
    std::size_t k = 0;
    while (k + 2 < knots.size() && at > knots[k + 1])
      ++k;
    const double part = (at - knots[k]) / (knots[k + 1] - knots[k]);
    out(n, static_cast<Eigen::Index>(k)) = 1.0 - part;
    out(n, static_cast<Eigen::Index>(k) + 1) = part;
  }
  return out;
}

Range rangeOf(std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  return {values[values.size() / 200], values[values.size() - 1 - values.size() / 200]};
}

std::vector<double> evenKnots(const std::vector<double>& sorted, const Range& range, bool history, int count) {
  std::vector<double> knots;
  for (int k = 0; k < count; ++k) {
    const double share = static_cast<double>(k) / (count - 1);
    const double quantile = sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
    const double even =
        range.low + share * (history ? std::pow(kHistoryRange, share - 1.0) : 1.0) * (range.high - range.low);
    knots.push_back((1.0 - kEvenShare) * std::clamp(quantile, range.low, range.high) + kEvenShare * even);
  }
  return knots;
}

std::vector<double> knotsAtZero(const Range& range) {
  const double low = range.low, high = range.high, largest = std::max(-low, high);
  return {low, 0.25 * low, -0.05 * largest, -0.01 * largest, 0.01 * largest, 0.05 * largest, 0.25 * high, high};
}

std::vector<ShapeParameter> knotParameters(int count) {
  std::vector<ShapeParameter> out;
  for (int k = 1; k <= count; ++k)
    out.push_back({"knot_" + std::to_string(k), -1e9, 1e9, true});
  return out;
}

std::vector<Coefficient> knotCoefficients(const std::string& what, const std::string& unit, int count) {
  std::vector<Coefficient> out;
  for (int k = 1; k <= count; ++k) {
    std::string name = what;
    name.append("_at_knot_").append(std::to_string(k)).append("_").append(unit);
    out.push_back({std::move(name), false});
  }
  return out;
}

}  // namespace knee_robot::tracing
