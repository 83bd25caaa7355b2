// {name: passive_joint, coordinate: theta, width_rad: 0.12, towards_positive_Nm: 3, towards_negative_Nm: 6,
//  damping_Nm_s_per_rad: 2, yield_Nm: 1, yield_rad: 0.05}
// A joint of whoever is on the platform turns with theta or psi; its moment against them grows exponentially, by a factor
// of e each width, towards both ends of its range. Its tissue damps, and resists by a moment that builds up over an angle
// after each reversal.
#include <algorithm>
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

constexpr double kMostMoment_Nm = 1e4;  // beyond it nobody's joint lasts, and no number either

class PassiveJoint : public EffectOf<PassiveJoint> {
 public:
  explicit PassiveJoint(StrictMap& entry)
      : coordinate_(entry.choice("coordinate", {"theta", "psi"}) == "theta" ? 2 : 3),
        width_rad_(entry.number("width_rad", 0.02, 1.0)),
        positive_Nm_(entry.number("towards_positive_Nm", 0.0, 1e3)),
        negative_Nm_(entry.number("towards_negative_Nm", 0.0, 1e3)),
        damping_Nm_s_(entry.numberOr("damping_Nm_s_per_rad", 0.0, 0.0, 100.0)),
        yield_Nm_(entry.numberOr("yield_Nm", 0.0, 0.0, 1e3)),
        yield_rad_(entry.numberOr("yield_rad", 0.05, 0.002, 1.0)) {}
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    const double turned = at.pose[coordinate_] / width_rad_;
    const auto grown = [](double moment, double by) { return std::min(moment * std::exp(by), kMostMoment_Nm); };
    loads.pose_force[coordinate_] -= grown(positive_Nm_, turned) - grown(negative_Nm_, -turned) +
                                     damping_Nm_s_ * at.pose_velocity[coordinate_] + yield_Nm_ * yielded_;
  }
  void follow(const EffectStep& now) noexcept override {
    const double way_rad = now.pose_velocity[coordinate_] * now.dt_s, to = way_rad > 0.0 ? 1.0 : -1.0;
    yielded_ = to + (yielded_ - to) * std::exp(-std::abs(way_rad) / yield_rad_);
  }

 private:
  Eigen::Index coordinate_;
  double width_rad_, positive_Nm_, negative_Nm_, damping_Nm_s_, yield_Nm_, yield_rad_;
  double yielded_ = 0.0;  ///< share of yield_Nm
};

}  // namespace

std::unique_ptr<Effect> makePassiveJoint(StrictMap& entry) {
  return std::make_unique<PassiveJoint>(entry);
}

}  // namespace knee_robot::simulation
