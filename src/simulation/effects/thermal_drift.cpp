// {name: thermal_drift, actuators: [2], viscous_change: -0.4, coulomb_change: -0.2, time_constant_s: 40} Friction
// changes while the machine warms up: the axis' levels times 1 + change (1 - exp(-t / time constant)), t since the
// simulation began. Acts on the levels of the effects before it too.
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class ThermalDrift : public EffectOf<ThermalDrift> {
 public:
  explicit ThermalDrift(StrictMap& entry)
      : actuators_(readActuators(entry)),
        viscous_change_(entry.numberOr("viscous_change", 0.0, -1.0, 10.0)),
        coulomb_change_(entry.numberOr("coulomb_change", 0.0, -1.0, 10.0)),
        time_constant_s_(entry.number("time_constant_s", 0.1, 1e5)) {}
  void changeFriction(const EffectStep& at, PlantLoads& loads) noexcept override {
    const double warm = 1.0 - std::exp(-at.time_s / time_constant_s_);
    loads.viscous += viscous_change_ * warm * actuators_.cwiseProduct(loads.viscous);
    loads.coulomb += coulomb_change_ * warm * actuators_.cwiseProduct(loads.coulomb);
  }

 private:
  mechanism::Vector4 actuators_;
  double viscous_change_;
  double coulomb_change_;
  double time_constant_s_;
};

}  // namespace

std::unique_ptr<Effect> makeThermalDrift(StrictMap& entry) {
  return std::make_unique<ThermalDrift>(entry);
}

}  // namespace knee_robot::simulation
