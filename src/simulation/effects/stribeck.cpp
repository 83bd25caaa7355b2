// {name: stribeck, actuators: [2], excess_N: 10, velocity_m_per_s: 0.005, exponent: 2}
// Coulomb friction is larger near rest: excess_N exp(-|v / velocity|^exponent) more (exponent optional, 2).
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class Stribeck : public EffectOf<Stribeck> {
 public:
  explicit Stribeck(StrictMap& entry)
      : excess_N_(entry.number("excess_N", 0.0, 1e4) * readActuators(entry)),
        velocity_(entry.number("velocity_m_per_s", 1e-5, 1.0)),
        exponent_(entry.numberOr("exponent", 2.0, 0.3, 4.0)) {}
  void changeFriction(const EffectStep& at, PlantLoads& loads) noexcept override {
    for (int i = 0; i < mechanism::kLegs; ++i)
      loads.coulomb[i] += excess_N_[i] * std::exp(-std::pow(std::abs(at.rates[i]) / velocity_, exponent_));
  }

 private:
  mechanism::Vector4 excess_N_;
  double velocity_;
  double exponent_;
};

}  // namespace

std::unique_ptr<Effect> makeStribeck(StrictMap& entry) {
  return std::make_unique<Stribeck>(entry);
}

}  // namespace knee_robot::simulation
