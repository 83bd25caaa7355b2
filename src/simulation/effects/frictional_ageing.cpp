// {name: frictional_ageing, actuators: [2], excess_N: 10, time_constant_s: 2, way_m: 0.006}
// Coulomb friction grows by up to excess_N while the axis stands, with a time constant, and the growth wears off over a
// way: d aged/dt = (1 - aged) / time constant - aged |v| / way. The robot has stood before the simulation begins.
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class FrictionalAgeing : public EffectOf<FrictionalAgeing> {
 public:
  explicit FrictionalAgeing(StrictMap& entry)
      : excess_N_(entry.number("excess_N", 0.0, 1e4) * readActuators(entry)),
        time_constant_s_(entry.number("time_constant_s", 0.1, 1e5)),
        way_m_(entry.number("way_m", 1e-4, 1.0)) {}
  void changeFriction(const EffectStep&, PlantLoads& loads) noexcept override {
    loads.coulomb += excess_N_.cwiseProduct(aged_);
  }
  void follow(const EffectStep& now) noexcept override {
    for (int i = 0; i < mechanism::kLegs; ++i) {
      const double rate = std::abs(now.rates[i]) / way_m_ + 1.0 / time_constant_s_;
      const double settled = 1.0 / (time_constant_s_ * rate);
      aged_[i] = settled + (aged_[i] - settled) * std::exp(-rate * now.dt_s);
    }
  }

 private:
  mechanism::Vector4 excess_N_;
  double time_constant_s_, way_m_;
  mechanism::Vector4 aged_ = mechanism::Vector4::Ones();
};

}  // namespace

std::unique_ptr<Effect> makeFrictionalAgeing(StrictMap& entry) {
  return std::make_unique<FrictionalAgeing>(entry);
}

}  // namespace knee_robot::simulation
