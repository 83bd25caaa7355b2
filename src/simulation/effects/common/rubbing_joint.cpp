#include "rubbing_joint.h"

namespace knee_robot::simulation {

RubbingJoint::RubbingJoint(StrictMap& entry)
    : coulomb_N_m_(entry.number("coulomb_N_m", 0.0, 1e3)),
      viscous_N_m_s_per_rad_(entry.numberOr("viscous_N_m_s_per_rad", 0.0, 0.0, 1e3)) {}

}  // namespace knee_robot::simulation
