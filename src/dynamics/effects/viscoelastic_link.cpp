#include <cmath>

#include "line.h"

namespace knee_robot::dynamics {
namespace {

/// A spring in series with a damper between base and platform. Its state is how far the spring is stretched, in m.
class ViscoelasticLink : public EffectLaw {
 public:
  explicit ViscoelasticLink(const Shape& shape)
      : anchors_(shape[0], shape[1], shape[2], shape[3]), relaxation_s_(shape[4]) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  bool shared() const noexcept override { return true; }
  void poseColumns(const EffectInstant& at, EffectState& state, PoseColumns& out) const noexcept override {
    const Line line = lineAt(*at.motion, anchors_);
    const double keeps = std::exp(-at.period_s / relaxation_s_);
    state.value = keeps * state.value + (1.0 - keeps) * relaxation_s_ * line.rate_m_per_s;
    out.col(0) = state.value * line.per_newton;
  }
  void rest(double duration_s, EffectState& state) const noexcept override {
    state.value *= std::exp(-duration_s / relaxation_s_);
  }

 private:
  const Eigen::Vector4d anchors_;
  const double relaxation_s_;
};

}  // namespace

Law viscoelasticLinkLaw(const Shape& shape) {
  if (!(shape[4] > 0.0)) return nullptr;  // it would grow by itself
  return std::make_unique<ViscoelasticLink>(shape);
}

}  // namespace knee_robot::dynamics
