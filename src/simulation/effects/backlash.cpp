// {name: backlash, actuators: [2], width_m: 0.0002, stiffness_N_per_m: 2e6, damping_N_s_per_m: 500} Play between motor
// and screw, as wide as width_m from stop to stop; the encoder is on the motor (see coupled_motors.h). Stiffness and
// damping (optional) are those of the contact.
#include "common/coupled_motors.h"

namespace knee_robot::simulation {
namespace {

class Backlash : public CoupledEffect<Backlash> {
 public:
  explicit Backlash(StrictMap& entry)
      : CoupledEffect({readActuators(entry), entry.numberOr("stiffness_N_per_m", 2e6, 1e3, 1e9),
                       entry.numberOr("damping_N_s_per_m", 500.0, 0.0, 1e5),
                       0.5 * entry.number("width_m", 0.0, 0.05)}) {}
};

}  // namespace

std::unique_ptr<Effect> makeBacklash(StrictMap& entry) {
  return std::make_unique<Backlash>(entry);
}

}  // namespace knee_robot::simulation
