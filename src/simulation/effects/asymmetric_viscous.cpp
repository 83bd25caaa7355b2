// {name: asymmetric_viscous, actuators: [2], difference_N_s_per_m: 200} Viscous friction is half the difference larger
// while the leg lengthens and as much smaller while it shortens (never negative).
#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class AsymmetricViscous : public EffectOf<AsymmetricViscous> {
 public:
  explicit AsymmetricViscous(StrictMap& entry)
      : half_(0.5 * entry.number("difference_N_s_per_m", -1e5, 1e5) * readActuators(entry)) {}
  void changeFriction(const EffectStep& at, PlantLoads& loads) noexcept override {
    loads.viscous = (loads.viscous + half_.cwiseProduct(at.rates.cwiseSign())).cwiseMax(0.0);
  }

 private:
  mechanism::Vector4 half_;
};

}  // namespace

std::unique_ptr<Effect> makeAsymmetricViscous(StrictMap& entry) {
  return std::make_unique<AsymmetricViscous>(entry);
}

}  // namespace knee_robot::simulation
