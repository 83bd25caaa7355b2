// {name: one_sided_spring, force_at_0.1_m_N: 90, anchor_m: [-0.3, 0.2, 1.5], point_m: [0.1, 0, 0], acts_from_m: 1.0,
//  side: longer, exponent: 1.3, lost_at_0.1_m_N: 15, lost_over_m: 0.002}
// A strap that goes taut beyond a length (side: longer), or a stop that pushes below it (side: shorter), between a point
// of the base (base frame) and one of the platform (platform frame); a part is lost with the direction.
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

constexpr double kPerWay_m = 0.1;

class OneSidedSpring : public EffectOf<OneSidedSpring> {
 public:
  explicit OneSidedSpring(StrictMap& entry)
      : force_N_(entry.number("force_at_0.1_m_N", 0.0, 1e5)),
        lost_N_(entry.numberOr("lost_at_0.1_m_N", 0.0, 0.0, 1e5)),
        lost_over_m_(entry.numberOr("lost_over_m", 0.002, 1e-4, 0.1)),
        exponent_(entry.numberOr("exponent", 1.0, 1.0, 2.0)),
        anchor_m_(readVector3(entry, "anchor_m", -10.0, 10.0)),
        point_m_(readVector3(entry, "point_m", -2.0, 2.0)),
        acts_from_m_(entry.number("acts_from_m", 0.0, 10.0)),
        side_(entry.choice("side", {"longer", "shorter"}) == "longer" ? 1.0 : -1.0) {}
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    const mechanism::Vector3 span = platformPoint(at.pose, point_m_) - anchor_m_;
    const double length = span.norm(), within_m = side_ * (length - acts_from_m_);
    if (length < 1e-6 || within_m <= 0.0) return;
    const double resists =
        std::pow(within_m / kPerWay_m, exponent_) * (side_ * force_N_ + lost_N_ * direction_of_travel_);
    loads.pose_force += poseForceOf(at.pose, point_m_, -resists / length * span);
  }
  void follow(const EffectStep& now) noexcept override {
    const mechanism::Vector3 span = platformPoint(now.pose, point_m_) - anchor_m_;
    const double way_m = poseForceOf(now.pose, point_m_, span.normalized()).dot(now.pose_velocity) * now.dt_s;
    const double to = way_m > 0.0 ? 1.0 : -1.0;
    direction_of_travel_ = to + (direction_of_travel_ - to) * std::exp(-std::abs(way_m) / lost_over_m_);
  }

 private:
  double force_N_, lost_N_, lost_over_m_, exponent_;
  mechanism::Vector3 anchor_m_;
  mechanism::Vector3 point_m_;
  double acts_from_m_, side_;
  double direction_of_travel_ = 0.0;  ///< comes up over a way after each reversal
};

}  // namespace

std::unique_ptr<Effect> makeOneSidedSpring(StrictMap& entry) {
  return std::make_unique<OneSidedSpring>(entry);
}

}  // namespace knee_robot::simulation
