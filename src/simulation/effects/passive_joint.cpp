// {name: passive_joint, coordinate: theta, width_rad: 0.12, towards_positive_Nm: 3, towards_negative_Nm: 6} A joint of
// whoever is on the platform turns with theta or psi; its moment against them grows exponentially, by a factor of e each
// width, towards both ends of its range.
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
        negative_Nm_(entry.number("towards_negative_Nm", 0.0, 1e3)) {}
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    const double turned = at.pose[coordinate_] / width_rad_;
    const auto grown = [](double moment, double by) { return std::min(moment * std::exp(by), kMostMoment_Nm); };
    loads.pose_force[coordinate_] -= grown(positive_Nm_, turned) - grown(negative_Nm_, -turned);
  }

 private:
  Eigen::Index coordinate_;
  double width_rad_, positive_Nm_, negative_Nm_;
};

}  // namespace

std::unique_ptr<Effect> makePassiveJoint(StrictMap& entry) {
  return std::make_unique<PassiveJoint>(entry);
}

}  // namespace knee_robot::simulation
