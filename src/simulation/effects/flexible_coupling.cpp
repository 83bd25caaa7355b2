// {name: flexible_coupling, actuators: [2], stiffness_N_per_m: 2e5, damping_N_s_per_m: 100}
// Motor and screw are joined elastically; the encoder is on the motor (see coupled_motors.h).
#include "common/coupled_motors.h"

namespace knee_robot::simulation {
namespace {

class FlexibleCoupling : public CoupledEffect<FlexibleCoupling> {
 public:
  explicit FlexibleCoupling(StrictMap& entry)
      : CoupledEffect({readActuators(entry), entry.number("stiffness_N_per_m", 1e3, 1e9),
                       entry.numberOr("damping_N_s_per_m", 100.0, 0.0, 1e5), 0.0}) {}
};

}  // namespace

std::unique_ptr<Effect> makeFlexibleCoupling(StrictMap& entry) {
  return std::make_unique<FlexibleCoupling>(entry);
}

}  // namespace knee_robot::simulation
