// {name: flexible_coupling, actuators: [2], stiffness_N_per_m: 2e5, damping_N_s_per_m: 100}
// Motor and screw are joined elastically; the encoder is on the motor (see coupled_motors.h).
#include "common/coupled_motors.h"

namespace knee_robot::simulation {
namespace {

class FlexibleCoupling : public EffectOf<FlexibleCoupling> {
 public:
  explicit FlexibleCoupling(StrictMap& entry)
      : motors_({readActuators(entry), entry.number("stiffness_N_per_m", 1e3, 1e9),
                 entry.numberOr("damping_N_s_per_m", 100.0, 0.0, 1e5), 0.0}) {}
  void changePlant(PlantModel& model) override { motors_.takeRotors(model); }
  void start(const EffectStep& at) noexcept override { motors_.start(at.lengths); }
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override { motors_.push(at, loads); }
  void follow(const EffectStep& now) noexcept override { motors_.follow(now); }
  void changeEncoders(mechanism::Lengths& seen) const noexcept override { motors_.replace(seen); }

 private:
  CoupledMotors motors_;
};

}  // namespace

std::unique_ptr<Effect> makeFlexibleCoupling(StrictMap& entry) {
  return std::make_unique<FlexibleCoupling>(entry);
}

}  // namespace knee_robot::simulation
