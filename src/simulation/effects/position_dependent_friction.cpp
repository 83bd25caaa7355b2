// {name: position_dependent_friction, actuators: [3], amplitude_N: 12, center_m: 0.72, width_m: 0.03} Coulomb friction
// has a tight (or, with a negative amplitude, loose) place: amplitude exp(-((q - center) / width)^2) more.
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class PositionDependentFriction : public EffectOf<PositionDependentFriction> {
 public:
  explicit PositionDependentFriction(StrictMap& entry)
      : amplitude_N_(entry.number("amplitude_N", -1e4, 1e4) * readActuators(entry)),
        center_m_(entry.number("center_m", 0.0, 10.0)),
        width_m_(entry.number("width_m", 1e-4, 10.0)) {}
  void changeFriction(const EffectStep& at, PlantLoads& loads) noexcept override {
    for (int i = 0; i < mechanism::kLegs; ++i) {
      const double away = (at.lengths[i] - center_m_) / width_m_;
      loads.coulomb[i] = std::max(0.0, loads.coulomb[i] + amplitude_N_[i] * std::exp(-away * away));
    }
  }

 private:
  mechanism::Vector4 amplitude_N_;
  double center_m_;
  double width_m_;
};

}  // namespace

std::unique_ptr<Effect> makePositionDependentFriction(StrictMap& entry) {
  return std::make_unique<PositionDependentFriction>(entry);
}

}  // namespace knee_robot::simulation
