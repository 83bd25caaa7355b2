#include <algorithm>
#include <cmath>

#include "line.h"

namespace knee_robot::dynamics {
namespace {

/// A damper between base and platform that resists lengthening and shortening differently.
class AsymmetricDashpot : public EffectLaw {
 public:
  explicit AsymmetricDashpot(const Shape& shape)
      : anchors_(shape[0], shape[1], shape[2], shape[3]), exponent_(shape[4]) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  int coefficients() const noexcept override { return 2; }
  bool shared() const noexcept override { return true; }
  void poseColumns(const EffectInstant& at, EffectState&, PoseColumns& out) const noexcept override {
    const Line line = lineAt(*at.motion, anchors_);
    const double speed = std::hypot(line.rate_m_per_s, kSlow_m_per_s);
    const mechanism::Vector4 factor = std::pow(speed, exponent_ - 1.0) * line.per_newton;
    out.col(0) = std::max(0.0, line.rate_m_per_s) * factor;
    out.col(1) = std::min(0.0, line.rate_m_per_s) * factor;
  }

 private:
  const Eigen::Vector4d anchors_;
  const double exponent_;
};

}  // namespace

Law asymmetricDashpotLaw(const Shape& shape) {
  return std::make_unique<AsymmetricDashpot>(shape);
}

}  // namespace knee_robot::dynamics
