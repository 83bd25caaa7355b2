#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace knee_robot {

/// What stands at `share` (below 1) of these values, of which there is at least one, when they are sorted.
template <typename Value>
Value quantile(std::vector<Value> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Of an even number the greater one of the two in the middle.
template <typename Value>
Value median(std::vector<Value> values) {
  return quantile(std::move(values), 0.5);
}

}  // namespace knee_robot
