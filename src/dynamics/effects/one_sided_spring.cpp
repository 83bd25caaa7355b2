#include <algorithm>
#include <cmath>

#include "line.h"

namespace knee_robot::dynamics {
namespace {

constexpr double kPerWay_m = 0.1;  ///< at which the coefficients are the force

/// Pulls beyond a length (side 1), or pushes below it (side -1), between base and platform; a part of it is lost.
/// Its state is the direction of travel, which comes up over a way after each reversal.
class OneSidedSpring : public EffectLaw {
 public:
  explicit OneSidedSpring(const Shape& shape)
      : anchors_(shape[0], shape[1], shape[2], shape[3]),
        base_z_m_(shape[4]),
        acts_from_m_(shape[5]),
        exponent_(shape[6]),
        lost_over_m_(shape[7]),
        side_(std::copysign(1.0, shape[8])) {}
  EffectPart part() const noexcept override { return EffectPart::Carried; }
  int coefficients() const noexcept override { return 2; }
  bool shared() const noexcept override { return true; }
  void poseColumns(const EffectInstant& at, EffectState& state, PoseColumns& out) const noexcept override {
    const Line line = lineAt(*at.motion, anchors_, base_z_m_);
    const double within_m = std::max(0.0, side_ * (line.length_m - acts_from_m_));
    const double within = std::pow(within_m / kPerWay_m, exponent_);
    out.col(0) = side_ * within * line.per_newton;
    const double way_m = 0.5 * (line.rate_m_per_s + state.rate) * at.period_s, to = way_m > 0.0 ? 1.0 : -1.0;
    state.value = to + (state.value - to) * std::exp(-std::abs(way_m) / lost_over_m_);
    state.rate = line.rate_m_per_s;
    out.col(1) = within * state.value * line.per_newton;
  }

 private:
  const Eigen::Vector4d anchors_;
  const double base_z_m_, acts_from_m_, exponent_, lost_over_m_, side_;
};

}  // namespace

Law oneSidedSpringLaw(const Shape& shape) {
  if (!(shape[6] > 0.0 && shape[7] > 0.0)) return nullptr;
  return std::make_unique<OneSidedSpring>(shape);
}

}  // namespace knee_robot::dynamics
