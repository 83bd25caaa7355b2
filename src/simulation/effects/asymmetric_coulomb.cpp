// {name: asymmetric_coulomb, actuators: [2], difference_N: 8} Coulomb friction is half the difference larger while the
// leg lengthens and as much smaller while it shortens (never negative).
#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class AsymmetricCoulomb : public EffectOf<AsymmetricCoulomb> {
 public:
  explicit AsymmetricCoulomb(StrictMap& entry)
      : half_N_(0.5 * entry.number("difference_N", -1e3, 1e3) * readActuators(entry)) {}
  void changeFriction(const EffectStep& /*at*/, PlantLoads& loads) noexcept override {
    loads.coulomb_asymmetry += half_N_;
  }

 private:
  mechanism::Vector4 half_N_;
};

}  // namespace

std::unique_ptr<Effect> makeAsymmetricCoulomb(StrictMap& entry) {
  return std::make_unique<AsymmetricCoulomb>(entry);
}

}  // namespace knee_robot::simulation
