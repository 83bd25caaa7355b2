// {name: external_force, start_s: 20, end_s: 23, rise_s: 0.2, force_N: [0, 0, -40], point_m: [0.1, 0, 0]} Someone
// pushes: a force (base frame) on a point of the platform (platform frame) from start to end of the simulated time,
// rising and falling linearly within rise_s (optional, 0.1).
#include <algorithm>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class ExternalForce : public EffectOf<ExternalForce> {
 public:
  explicit ExternalForce(StrictMap& entry)
      : start_s_(entry.number("start_s", 0.0, 1e6)),
        end_s_(entry.number("end_s", 0.0, 1e6)),
        rise_s_(entry.numberOr("rise_s", 0.1, 1e-3, 100.0)),
        force_N_(readVector3(entry, "force_N", -1e4, 1e4)),
        point_m_(readVector3(entry, "point_m", -2.0, 2.0)) {
    if (end_s_ <= start_s_) entry.refuse("end_s", "is not after start_s; give a later one");
  }
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    const double inside = std::min(at.time_s - start_s_, end_s_ - at.time_s);
    if (inside <= 0.0) return;
    loads.pose_force += poseForceOf(at.pose, point_m_, std::min(1.0, inside / rise_s_) * force_N_);
  }

 private:
  double start_s_;
  double end_s_;
  double rise_s_;
  mechanism::Vector3 force_N_;
  mechanism::Vector3 point_m_;
};

}  // namespace

std::unique_ptr<Effect> makeExternalForce(StrictMap& entry) {
  return std::make_unique<ExternalForce>(entry);
}

}  // namespace knee_robot::simulation
