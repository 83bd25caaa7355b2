#include <algorithm>
#include <cmath>

#include "knee_robot/mechanism/leg_distance.h"
#include "laws.h"

namespace knee_robot::dynamics {
namespace {

/// A hose or a cable bundle between two legs: pulls beyond a length (side 1) or pushes below it (side -1), damps as long
/// as it does, and rubs. Its state is the share of that friction, which comes up over a way after each reversal.
class LinkBetweenLegs : public EffectLaw {
 public:
  explicit LinkBetweenLegs(const Shape& shape)
      : pair_{whole(shape[0]) - 1, whole(shape[1]) - 1, static_cast<mechanism::BetweenLegs>(whole(shape[2]))},
        acts_from_m_(shape[3]),
        side_(std::copysign(1.0, shape[4])),
        rubs_over_m_(shape[5]) {}
  static bool isPossible(const Shape& shape) {
    const auto isLeg = [](double leg) { return leg >= 1.0 && leg <= mechanism::kLegs; };
    return isLeg(shape[0]) && isLeg(shape[1]) && shape[2] >= 0.0 && shape[2] <= 2.0 && shape[5] > 0.0;
  }
  EffectPart part() const noexcept override { return EffectPart::Carried; }
  int coefficients() const noexcept override { return 4; }
  bool shared() const noexcept override { return true; }
  void poseColumns(const EffectInstant& at, EffectState& state, PoseColumns& out) const noexcept override {
    const mechanism::LegDistance now = mechanism::legDistance(*at.mechanism, at.motion->pose, pair_);
    const double taut_m = std::max(0.0, side_ * (now.length_m - acts_from_m_));
    const double rate = now.by_pose.dot(at.motion->pose_velocity);
    const double way_m = 0.5 * (rate + state.rate) * at.period_s, to = way_m > 0.0 ? 1.0 : -1.0;
    state.value = to + (state.value - to) * std::exp(-std::abs(way_m) / rubs_over_m_);
    state.rate = rate;
    out.col(0) = side_ * taut_m * now.by_pose;
    out.col(1) = side_ * taut_m * taut_m * now.by_pose;
    out.col(2) = (taut_m > 0.0 ? rate : 0.0) * now.by_pose;
    out.col(3) = state.value * now.by_pose;
  }

 private:
  static int whole(double number) { return static_cast<int>(std::lround(number)); }

  const mechanism::LegPair pair_;
  const double acts_from_m_, side_, rubs_over_m_;
};

}  // namespace

Law linkBetweenLegsLaw(const Shape& shape) {
  if (!LinkBetweenLegs::isPossible(shape)) return nullptr;
  return std::make_unique<LinkBetweenLegs>(shape);
}

}  // namespace knee_robot::dynamics
