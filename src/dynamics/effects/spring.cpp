#include "line.h"

namespace knee_robot::dynamics {
namespace {

/// A spring between base and platform: stiffness times length, less stiffness times free length.
class Spring : public EffectLaw {
 public:
  explicit Spring(const Shape& shape) : anchors_(shape[0], shape[1], shape[2], shape[3]) {}
  EffectPart part() const noexcept override { return EffectPart::Carried; }
  int coefficients() const noexcept override { return 2; }
  bool shared() const noexcept override { return true; }
  void poseColumns(const EffectInstant& at, EffectState&, PoseColumns& out) const noexcept override {
    const Line line = lineAt(*at.motion, anchors_);
    out.col(0) = line.length_m * line.per_newton;
    out.col(1) = -line.per_newton;
  }

 private:
  const Eigen::Vector4d anchors_;
};

}  // namespace

Law springLaw(const Shape& shape) {
  return std::make_unique<Spring>(shape);
}

}  // namespace knee_robot::dynamics
