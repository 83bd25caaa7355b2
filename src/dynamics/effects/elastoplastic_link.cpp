#include <cmath>

#include "line.h"

namespace knee_robot::dynamics {
namespace {

/// Dry friction along a line between base and platform (Dahl): builds up over a way after each reversal. Its state is
/// the share of that.
class ElastoplasticLink : public EffectLaw {
 public:
  explicit ElastoplasticLink(const Shape& shape)
      : anchors_(shape[0], shape[1], shape[2], shape[3]), base_z_m_(shape[4]), yield_m_(shape[5]) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  bool shared() const noexcept override { return true; }
  void poseColumns(const EffectInstant& at, EffectState& state, PoseColumns& out) const noexcept override {
    const Line line = lineAt(*at.motion, anchors_, base_z_m_);
    const double way_m = 0.5 * (line.rate_m_per_s + state.rate) * at.period_s, to = way_m > 0.0 ? 1.0 : -1.0;
    state.value = to + (at.fade * state.value - to) * std::exp(-std::abs(way_m) / yield_m_);
    state.rate = line.rate_m_per_s;
    out.col(0) = state.value * line.per_newton;
  }

 private:
  const Eigen::Vector4d anchors_;
  const double base_z_m_, yield_m_;
};

}  // namespace

Law elastoplasticLinkLaw(const Shape& shape) {
  if (!(shape[5] > 0.0)) return nullptr;
  return std::make_unique<ElastoplasticLink>(shape);
}

}  // namespace knee_robot::dynamics
