// {name: load_ripple, actuators: [1], share: 0.05, period_m: 0.01, phase_deg: 30} A force that repeats with the screw's
// angle in proportion to what the leg passes on (of the substep before), as the torque ripple of a motor: share
// transmitted sin(2 pi q / period + phase).
#include "common/ripple.h"
#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class LoadRipple : public EffectOf<LoadRipple> {
 public:
  explicit LoadRipple(StrictMap& entry)
      : share_(entry.number("share", 0.0, 0.9) * readActuators(entry)), ripple_(entry) {}
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    for (int i = 0; i < mechanism::kLegs; ++i)
      loads.motor_force[i] += share_[i] * at.transmitted_N[i] * ripple_.at(at.lengths[i]);
  }

 private:
  mechanism::Vector4 share_;
  Ripple ripple_;
};

}  // namespace

std::unique_ptr<Effect> makeLoadRipple(StrictMap& entry) {
  return std::make_unique<LoadRipple>(entry);
}

}  // namespace knee_robot::simulation
