#include "line.h"

namespace knee_robot::dynamics {
namespace {

constexpr double kMiddle_m = 0.7;  ///< as in its tracing

/// A cable, a strap or a limb between base and platform: powers of the length beyond kMiddle_m.
class NonlinearSpring : public EffectLaw {
 public:
  explicit NonlinearSpring(const Shape& shape) : anchors_(shape[0], shape[1], shape[2], shape[3]) {}
  EffectPart part() const noexcept override { return EffectPart::Carried; }
  int coefficients() const noexcept override { return 4; }
  bool shared() const noexcept override { return true; }
  void poseColumns(const mechanism::Motion& motion, PoseColumns& out) const noexcept override {
    const Line line = lineAt(motion, anchors_);
    out.col(0) = line.per_newton;
    for (int power = 1; power < coefficients(); ++power)
      out.col(power) = (line.length_m - kMiddle_m) * out.col(power - 1);
  }

 private:
  const Eigen::Vector4d anchors_;
};

}  // namespace

Law nonlinearSpringLaw(const Shape& shape) {
  return std::make_unique<NonlinearSpring>(shape);
}

}  // namespace knee_robot::dynamics
