#include "knee_robot/report/plot_series.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "knee_robot/base/constants.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::report {
namespace {

constexpr std::size_t kMostPoints = 1500;
constexpr double kFlat = 1e-9;  ///< a span that is smaller beside its values is rounding
constexpr int kMostDecimals = 15;

/// Decimals that leave a 10^-digits-th of the values' span.
int decimalsOf(const std::vector<double>& values, int digits) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  const double size = std::max(std::abs(low), std::abs(high));
  const double span = high - low > kFlat * size ? high - low : size;
  if (!(span > 0.0) || !std::isfinite(span)) return 0;
  return std::clamp(digits - static_cast<int>(std::floor(std::log10(span))), 0, kMostDecimals);
}

/// Smallest and largest finite value of values[from, to), in the order in which they come; NaN when there is none.
std::pair<double, double> extremes(const Eigen::VectorXd& values, std::size_t from, std::size_t to) {
  std::size_t low = to, high = to;
  for (std::size_t k = from; k < to; ++k) {
    const double v = values[static_cast<Eigen::Index>(k)];
    if (!std::isfinite(v)) continue;
    if (low == to || v < values[static_cast<Eigen::Index>(low)]) low = k;
    if (high == to || v > values[static_cast<Eigen::Index>(high)]) high = k;
  }
  if (low == to) return {kNan, kNan};
  return {values[static_cast<Eigen::Index>(std::min(low, high))],
          values[static_cast<Eigen::Index>(std::max(low, high))]};
}

Json rounded(const std::vector<double>& values, int digits) {
  const int decimals = decimalsOf(values, digits);
  Json out = Json::array();
  for (const double v : values) {
    if (!std::isfinite(v)) {
      out.push_back(nullptr);
      continue;
    }
    char text[400];
    std::snprintf(text, sizeof text, "%.*f", decimals, v);
    const double shown = std::strtod(text, nullptr);  // the double that is written with these digits
    out.push_back(shown == 0.0 ? 0.0 : shown);        // no -0
  }
  return out;
}

}  // namespace

Json plotNumbers(const std::vector<double>& values) {
  return rounded(values, 3);
}

Json logNumbers(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double v : values)
    out.push_back(std::isfinite(v) ? Json(*parseFinite(shortNumber(v, 4))) : Json());
  return out;
}

PlotSeries::PlotSeries(const std::vector<double>& x)
    : points_(x.size()), stretch_(x.size() <= kMostPoints ? 1 : 2 * x.size() / kMostPoints + 1) {
  std::vector<double> kept;
  for (std::size_t from = 0; from < points_; from += stretch_) {
    kept.push_back(x[from]);
    if (stretch_ > 1) kept.push_back(x[std::min(points_ - 1, from + stretch_ / 2)]);
  }
  x_ = rounded(kept, 4);  // neighbours stay apart
}

Json PlotSeries::line(const Eigen::VectorXd& values) const {
  std::vector<double> kept;
  for (std::size_t from = 0; from < points_; from += stretch_) {
    const auto [first, second] = extremes(values, from, std::min(points_, from + stretch_));
    kept.push_back(first);
    if (stretch_ > 1) kept.push_back(second);
  }
  return plotNumbers(kept);
}

Json PlotSeries::lines(const Eigen::MatrixXd& columns) const {
  Json out = Json::array();
  for (Eigen::Index i = 0; i < columns.cols(); ++i)
    out.push_back(line(columns.col(i)));
  return out;
}

}  // namespace knee_robot::report
