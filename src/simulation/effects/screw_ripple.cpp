// {name: screw_ripple, actuators: [1], amplitude_N: 5, period_m: 0.01, phase_deg: 30} A force that repeats with the
// screw's angle, whatever the direction (cogging, a bent screw): amplitude sin(2 pi q / period + phase).
#include "common/ripple.h"
#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class ScrewRipple : public EffectOf<ScrewRipple> {
 public:
  explicit ScrewRipple(StrictMap& entry)
      : amplitude_N_(entry.number("amplitude_N", 0.0, 1e4) * readActuators(entry)), ripple_(entry) {}
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    for (int i = 0; i < mechanism::kLegs; ++i)
      loads.motor_force[i] += amplitude_N_[i] * ripple_.at(at.lengths[i]);
  }

 private:
  mechanism::Vector4 amplitude_N_;
  Ripple ripple_;
};

}  // namespace

std::unique_ptr<Effect> makeScrewRipple(StrictMap& entry) {
  return std::make_unique<ScrewRipple>(entry);
}

}  // namespace knee_robot::simulation
