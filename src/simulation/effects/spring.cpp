// {name: spring, stiffness_N_per_m: 400, anchor_m: [0.2, 0.3, 0], point_m: [0.2, 0.2, 0], free_length_m: 0.5} A spring
// between a point of the base (base frame) and one of the platform (platform frame); pulls beyond its free length and
// pushes below it.
#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class Spring : public EffectOf<Spring> {
 public:
  explicit Spring(StrictMap& entry)
      : stiffness_(entry.number("stiffness_N_per_m", 0.0, 1e5)),
        anchor_m_(readVector3(entry, "anchor_m", -10.0, 10.0)),
        point_m_(readVector3(entry, "point_m", -2.0, 2.0)),
        free_length_m_(entry.numberOr("free_length_m", 0.0, 0.0, 10.0)) {}
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    const mechanism::Vector3 span = platformPoint(at.pose, point_m_) - anchor_m_;
    const double length = span.norm();
    if (length < 1e-6) return;  // no direction
    loads.pose_force += poseForceOf(at.pose, point_m_, -stiffness_ * (1.0 - free_length_m_ / length) * span);
  }

 private:
  double stiffness_;
  mechanism::Vector3 anchor_m_;
  mechanism::Vector3 point_m_;
  double free_length_m_;
};

}  // namespace

std::unique_ptr<Effect> makeSpring(StrictMap& entry) {
  return std::make_unique<Spring>(entry);
}

}  // namespace knee_robot::simulation
