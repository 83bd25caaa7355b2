#pragma once

#include <algorithm>

namespace knee_robot::dynamics {

/// Coulomb friction that remembers: the share of full friction, in [-1, 1], follows the displacement and saturates
/// after `width_m` (the stop operator of Prandtl; Dahl's model in its ideally plastic limit). Moving, it equals
/// sign(v); at rest it keeps what the last movement left, where sign(v) means nothing. Real-time safe.
struct CoulombMemory {
  double share = 0.0;

  /// `displacement_m` since the last call, `width_m` positive. Returns the new share.
  double step(double displacement_m, double width_m) noexcept {
    share = std::clamp(share + displacement_m / width_m, -1.0, 1.0);
    return share;
  }
};

}  // namespace knee_robot::dynamics
