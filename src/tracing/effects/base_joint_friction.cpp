#include "common/joint_friction.h"

namespace knee_robot::tracing {
namespace {

/// Friction of the joints between base and legs, eq. (22) and (23). The baseline leaves it out: on robots of this kind
/// it is hardly told apart from the actuators' own, unless it is large.
class BaseJointFriction : public JointFriction {
 public:
  BaseJointFriction() : JointFriction(dynamics::baseJointColumns, dynamics::kBaseJointColumns) {}
  std::string name() const override { return "base_joint_friction"; }
  std::string sentence() const override {
    return "The joints between the base and the legs rub: the revolute joint of leg 4 and the universal joints of legs "
           "1 to 3.";
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"leg_4_coulomb_N_m", true},
            {"leg_4_viscous_N_m_s_per_rad", true},
            {"universal_joints_coulomb_N_m", true},
            {"universal_joints_viscous_N_m_s_per_rad", true}};
  }
};

}  // namespace

std::unique_ptr<Candidate> makeBaseJointFriction() {
  return std::make_unique<BaseJointFriction>();
}

}  // namespace knee_robot::tracing
