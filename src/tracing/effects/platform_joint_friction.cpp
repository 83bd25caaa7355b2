#include "common/joint_friction.h"

namespace knee_robot::tracing {
namespace {

/// Friction of the joints between legs and platform, which eq. (23) has not; in a virtual plant of the paper's robot it
/// is what the rigid model misses most (Table 4).
class PlatformJointFriction : public JointFriction {
 public:
  PlatformJointFriction() : JointFriction(dynamics::platformJointColumns, dynamics::kPlatformJointColumns) {}
  std::string name() const override { return "platform_joint_friction"; }
  std::string sentence() const override {
    return "The joints between the legs and the platform rub: the universal joint of leg 4 and the spherical joints of "
           "legs 1 to 3.";
  }
  std::vector<Coefficient> coefficients(const EffectInput&) const override {
    return {{"leg_4_about_y_coulomb_N_m", true},    {"leg_4_about_y_viscous_N_m_s_per_rad", true},
            {"leg_4_about_psi_coulomb_N_m", true},  {"leg_4_about_psi_viscous_N_m_s_per_rad", true},
            {"spherical_joints_coulomb_N_m", true}, {"spherical_joints_viscous_N_m_s_per_rad", true}};
  }
};

}  // namespace

std::unique_ptr<Candidate> makePlatformJointFriction() {
  return std::make_unique<PlatformJointFriction>();
}

}  // namespace knee_robot::tracing
