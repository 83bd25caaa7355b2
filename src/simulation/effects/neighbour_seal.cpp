// {name: neighbour_seal, actuators: [2], neighbour: 3, friction_N: 12, center_m: 0.72, width_m: 0.04} Dry friction of
// an actuator that depends on where another one stands (a hose, a cable guide that both share): no class of trace
// describes it. friction (1 + tanh((q_neighbour - center) / width)) / 2 more.
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class NeighbourSeal : public EffectOf<NeighbourSeal> {
 public:
  explicit NeighbourSeal(StrictMap& entry)
      : friction_N_(entry.number("friction_N", 0.0, 1e4) * readActuators(entry)),
        neighbour_(static_cast<int>(entry.integer("neighbour", 1, mechanism::kLegs)) - 1),
        center_m_(entry.number("center_m", 0.0, 10.0)),
        width_m_(entry.number("width_m", 1e-4, 10.0)) {}
  void changeFriction(const EffectStep& at, PlantLoads& loads) noexcept override {
    loads.coulomb += 0.5 * (1.0 + std::tanh((at.lengths[neighbour_] - center_m_) / width_m_)) * friction_N_;
  }

 private:
  mechanism::Vector4 friction_N_;
  int neighbour_;
  double center_m_;
  double width_m_;
};

}  // namespace

std::unique_ptr<Effect> makeNeighbourSeal(StrictMap& entry) {
  return std::make_unique<NeighbourSeal>(entry);
}

}  // namespace knee_robot::simulation
