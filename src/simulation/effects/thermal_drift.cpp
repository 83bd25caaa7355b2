// {name: thermal_drift, actuators: [2], viscous_change: -0.4, coulomb_change: -0.2, time_constant_s: 40}
// {name: thermal_drift, viscous_change: -0.4, time_constant_s: 40, heated_by: work, full_heat_W: 0.5}
// Friction changes while the machine warms up: the axis' levels times 1 + change * warmth, d warmth/dt = (heat - warmth)
// / time constant, cold when the simulation begins. The heat is 1 (`clock`, the default), 1 while the axis moves
// (`motion`), or the power of its friction over `full_heat_W` (`work`). Acts on the levels of the effects before it too.
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

constexpr double kMoves_m_per_s = 2e-4;

class ThermalDrift : public EffectOf<ThermalDrift> {
 public:
  explicit ThermalDrift(StrictMap& entry)
      : actuators_(readActuators(entry)),
        viscous_change_(entry.numberOr("viscous_change", 0.0, -1.0, 10.0)),
        coulomb_change_(entry.numberOr("coulomb_change", 0.0, -1.0, 10.0)),
        time_constant_s_(entry.number("time_constant_s", 0.1, 1e5)) {
    const std::string heated_by = entry.choiceOr("heated_by", "clock", {"clock", "motion", "work"});
    by_motion_ = heated_by == "motion";
    if (heated_by == "work") full_heat_W_ = entry.number("full_heat_W", 1e-3, 1e4);
  }
  void changeFriction(const EffectStep&, PlantLoads& loads) noexcept override {
    loads.viscous += viscous_change_ * loads.viscous.cwiseProduct(actuators_.cwiseProduct(warmth_));
    loads.coulomb += coulomb_change_ * loads.coulomb.cwiseProduct(actuators_.cwiseProduct(warmth_));
    viscous_ = loads.viscous;
    coulomb_ = loads.coulomb;
  }
  void follow(const EffectStep& now) noexcept override {
    const double cooled = std::exp(-now.dt_s / time_constant_s_);
    for (int i = 0; i < mechanism::kLegs; ++i) {
      const double speed = std::abs(now.rates[i]);
      double heat = by_motion_ && speed < kMoves_m_per_s ? 0.0 : 1.0;
      if (full_heat_W_ > 0.0) heat = speed * (coulomb_[i] + viscous_[i] * speed) / full_heat_W_;
      warmth_[i] = heat + (warmth_[i] - heat) * cooled;
    }
  }

 private:
  mechanism::Vector4 actuators_;
  double viscous_change_;
  double coulomb_change_;
  double time_constant_s_;
  bool by_motion_ = false;
  double full_heat_W_ = 0.0;  ///< 0: heated otherwise
  mechanism::Vector4 warmth_ = mechanism::Vector4::Zero();
  mechanism::Vector4 viscous_ = mechanism::Vector4::Zero(), coulomb_ = mechanism::Vector4::Zero();  ///< of this substep
};

}  // namespace

std::unique_ptr<Effect> makeThermalDrift(StrictMap& entry) {
  return std::make_unique<ThermalDrift>(entry);
}

}  // namespace knee_robot::simulation
