#pragma once

#include <algorithm>

#include "laws.h"

namespace knee_robot::dynamics {

/// Of a piecewise linear function, a sum of hats. At least two, in ascending order, at most kMostColumns.
struct Knots {
  int count = 0;
  std::array<double, kMostColumns> at{};

  explicit Knots(const Shape& knots) : count(static_cast<int>(knots.size())) {
    std::copy(knots.begin(), knots.end(), at.begin());
  }

  /// The hats at x, times a factor. Constant beyond what training has seen.
  void hats(double x, double factor, EffectColumns& out) const noexcept {
    const std::size_t last = static_cast<std::size_t>(count - 1);
    x = std::clamp(x, at[0], at[last]);
    std::size_t k = 0;
    while (k + 1 < last && x > at[k + 1])
      ++k;
    const double part = (x - at[k]) / (at[k + 1] - at[k]);
    out.fill(0.0);
    out[k] = factor * (1.0 - part);
    out[k + 1] = factor * part;
  }
};

}  // namespace knee_robot::dynamics
