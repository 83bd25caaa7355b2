// {name: quadratic_drag, actuators: [1, 2], drag_N_s2_per_m2: 3000}
// A resistance of drag v |v|.
#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class QuadraticDrag : public EffectOf<QuadraticDrag> {
 public:
  explicit QuadraticDrag(StrictMap& entry) : drag_(entry.number("drag_N_s2_per_m2", 0.0, 1e7) * readActuators(entry)) {}
  void changeFriction(const EffectStep& at, PlantLoads& loads) noexcept override {
    loads.viscous += drag_.cwiseProduct(at.rates.cwiseAbs());
  }

 private:
  mechanism::Vector4 drag_;
};

}  // namespace

std::unique_ptr<Effect> makeQuadraticDrag(StrictMap& entry) {
  return std::make_unique<QuadraticDrag>(entry);
}

}  // namespace knee_robot::simulation
