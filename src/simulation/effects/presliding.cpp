// {name: presliding, actuators: [2], stiffness_N_per_m: 5e5, damping_N_s_per_m: 200} Coulomb friction acts through
// bristles (Dahl 1968, with the damping of LuGre, Canudas de Wit 1995): its force f follows the displacement x as df/dx
// = stiffness (1 - sign(v) f / level) and remembers it at rest; bristles that are stuck also damp. The level is
// whatever the axis and the effects before this one say, asymmetric and velocity-dependent ones included. An axis with
// bristles has no true rest: it is held elastically. Brakes hold rigidly as ever.
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class Presliding : public EffectOf<Presliding> {
 public:
  explicit Presliding(StrictMap& entry)
      : actuators_(readActuators(entry)),
        stiffness_(entry.number("stiffness_N_per_m", 1e3, 1e8)),
        damping_(entry.numberOr("damping_N_s_per_m", 200.0, 0.0, 1e5)) {}

  void start(const EffectStep& at) noexcept override { last_ = at.lengths; }

  /// The bristles' force at the end of the substep, linear in the velocity there: stable however stiff.
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    for (int i = 0; i < mechanism::kLegs; ++i) {
      if (actuators_[i] == 0.0) continue;
      lengthening_[i] = std::max(0.0, loads.coulomb[i] + loads.coulomb_asymmetry[i]);
      shortening_[i] = std::max(0.0, loads.coulomb[i] - loads.coulomb_asymmetry[i]);
      loads.coulomb[i] = loads.coulomb_asymmetry[i] = 0.0;
      const double rate = at.rates[i];
      const double level = rate > 0.0 ? lengthening_[i] : -shortening_[i];
      const double stuck = rate == 0.0 || level == 0.0 ? 1.0 : std::min(std::max(1.0 - force_[i] / level, 0.0), 2.0);
      const double slope = stuck * (stiffness_ * at.dt_s + damping_);  // of the force over the end velocity
      loads.viscous[i] += 2.0 * slope;
      loads.motor_force[i] += slope * rate - force_[i];
    }
  }

  void follow(const EffectStep& now) noexcept override {
    for (int i = 0; i < mechanism::kLegs; ++i) {
      const double moved = now.lengths[i] - last_[i];
      const double level = moved > 0.0 ? lengthening_[i] : -shortening_[i];
      force_[i] = level == 0.0 ? 0.0 : level + (force_[i] - level) * std::exp(-stiffness_ * moved / level);
    }
    last_ = now.lengths;
  }

 private:
  mechanism::Vector4 actuators_;
  double stiffness_;
  double damping_;
  mechanism::Vector4 force_ = mechanism::Vector4::Zero();  ///< N, against lengthening
  mechanism::Vector4 lengthening_ = mechanism::Vector4::Zero(), shortening_ = mechanism::Vector4::Zero();
  mechanism::Lengths last_ = mechanism::Lengths::Zero();
};

}  // namespace

std::unique_ptr<Effect> makePresliding(StrictMap& entry) {
  return std::make_unique<Presliding>(entry);
}

}  // namespace knee_robot::simulation
