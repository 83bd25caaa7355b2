#include <cmath>

#include "line.h"

namespace knee_robot::dynamics {
namespace {

/// A damper between base and platform, by a power of the rate at which their distance changes.
class Dashpot : public EffectLaw {
 public:
  explicit Dashpot(const Shape& shape) : anchors_(shape[0], shape[1], shape[2], shape[3]), exponent_(shape[4]) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  bool shared() const noexcept override { return true; }
  void poseColumns(const EffectInstant& at, EffectState&, PoseColumns& out) const noexcept override {
    const Line line = lineAt(*at.motion, anchors_);
    const double speed = std::hypot(line.rate_m_per_s, kSlow_m_per_s);
    out.col(0) = line.rate_m_per_s * std::pow(speed, exponent_ - 1.0) * line.per_newton;
  }

 private:
  const Eigen::Vector4d anchors_;
  const double exponent_;
};

}  // namespace

Law dashpotLaw(const Shape& shape) {
  return std::make_unique<Dashpot>(shape);
}

}  // namespace knee_robot::dynamics
