// {name: reflected_inertia, actuators: [2], mass_kg: 6}
// Rotor and screw are heavier than rotor_mass_kg says.
#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class ReflectedInertia : public EffectOf<ReflectedInertia> {
 public:
  explicit ReflectedInertia(StrictMap& entry) : mass_kg_(entry.number("mass_kg", 0.0, 1e3) * readActuators(entry)) {}
  void changePlant(PlantModel& model) override { model.rigid.rotor_mass += mass_kg_; }

 private:
  mechanism::Vector4 mass_kg_;
};

}  // namespace

std::unique_ptr<Effect> makeReflectedInertia(StrictMap& entry) {
  return std::make_unique<ReflectedInertia>(entry);
}

}  // namespace knee_robot::simulation
