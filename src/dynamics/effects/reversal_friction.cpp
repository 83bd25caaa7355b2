#include <cmath>

#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// Dry friction in excess after every reversal: share (1 - exp(-way / rise)) exp(-way / way of wear), along the path of
/// friction. Without a rise of its own it comes up as the law near rest does. The stroke that a motion begins with has
/// a share of it: nobody knows where that one began.
class ReversalFriction : public EffectLaw {
 public:
  explicit ReversalFriction(const Shape& shape) : way_m_(shape[0]), rise_m_(shape[1]), of_first_stroke_(shape[2]) {}
  EffectPart part() const noexcept override { return EffectPart::Friction; }
  void columns(const EffectInstant& at, EffectState&, EffectColumns& out) const noexcept override {
    const double way = at.since_reversal.way_of_last_m, risen = rise_m_ > 0.0 ? 1.0 - std::exp(-way / rise_m_) : 1.0;
    out[0] = (at.since_reversal.turned ? 1.0 : of_first_stroke_) * at.share * risen * std::exp(-way / way_m_);
  }

 private:
  const double way_m_, rise_m_, of_first_stroke_;
};

}  // namespace

Law reversalFrictionLaw(const Shape& shape) {
  if (!(shape[0] > 0.0) || !(shape[1] >= 0.0)) return nullptr;
  return std::make_unique<ReversalFriction>(shape);
}

}  // namespace knee_robot::dynamics
