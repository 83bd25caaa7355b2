// {name: viscoelastic_element, actuators: [2], stiffness_N_per_m: 300, relaxation_s: 2}
// A spring in series with a damper along the leg (bellows that leak, rubber): d stretched/dt = rate - stretched /
// relaxation. It is relaxed when the simulation begins.
#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

class ViscoelasticElement : public EffectOf<ViscoelasticElement> {
 public:
  explicit ViscoelasticElement(StrictMap& entry)
      : stiffness_(entry.number("stiffness_N_per_m", 0.0, 1e5) * readActuators(entry)),
        relaxation_s_(entry.number("relaxation_s", 0.01, 1e4)) {}
  void addLoads(const EffectStep&, PlantLoads& loads) noexcept override {
    loads.motor_force -= stiffness_.cwiseProduct(stretched_m_);
  }
  void follow(const EffectStep& now) noexcept override {
    const double keeps = std::exp(-now.dt_s / relaxation_s_);
    stretched_m_ = keeps * stretched_m_ + (1.0 - keeps) * relaxation_s_ * now.rates;
  }

 private:
  mechanism::Vector4 stiffness_;
  double relaxation_s_;
  mechanism::Vector4 stretched_m_ = mechanism::Vector4::Zero();
};

}  // namespace

std::unique_ptr<Effect> makeViscoelasticElement(StrictMap& entry) {
  return std::make_unique<ViscoelasticElement>(entry);
}

}  // namespace knee_robot::simulation
