// {name: load_dependent_friction, actuators: [4], share: 0.05} Coulomb friction grows with the load on the screw: share
// times the force that the leg passes on (of the substep before).
#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class LoadDependentFriction : public EffectOf<LoadDependentFriction> {
 public:
  explicit LoadDependentFriction(StrictMap& entry) : share_(entry.number("share", 0.0, 0.9) * readActuators(entry)) {}
  void changeFriction(const EffectStep& at, PlantLoads& loads) noexcept override {
    loads.coulomb += share_.cwiseProduct(at.transmitted_N.cwiseAbs());
  }

 private:
  mechanism::Vector4 share_;
};

}  // namespace

std::unique_ptr<Effect> makeLoadDependentFriction(StrictMap& entry) {
  return std::make_unique<LoadDependentFriction>(entry);
}

}  // namespace knee_robot::simulation
