#include <cmath>

#include "line.h"

namespace knee_robot::dynamics {
namespace {

/// Dry friction along a line between base and platform, smooth below a speed.
class LineFriction : public EffectLaw {
 public:
  explicit LineFriction(const Shape& shape)
      : anchors_(shape[0], shape[1], shape[2], shape[3]), base_z_m_(shape[4]), proportional_below_m_per_s_(shape[5]) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  bool shared() const noexcept override { return true; }
  void poseColumns(const EffectInstant& at, EffectState&, PoseColumns& out) const noexcept override {
    const Line line = lineAt(*at.motion, anchors_, base_z_m_);
    out.col(0) = line.rate_m_per_s / std::hypot(line.rate_m_per_s, proportional_below_m_per_s_) * line.per_newton;
  }

 private:
  const Eigen::Vector4d anchors_;
  const double base_z_m_, proportional_below_m_per_s_;
};

}  // namespace

Law lineFrictionLaw(const Shape& shape) {
  if (!(shape[5] > 0.0)) return nullptr;
  return std::make_unique<LineFriction>(shape);
}

}  // namespace knee_robot::dynamics
