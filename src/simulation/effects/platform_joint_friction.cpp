// {name: platform_joint_friction, coulomb_N_m: 1.5, viscous_N_m_s_per_rad: 2} Every joint between a leg and the
// platform rubs alike: leg 4's universal joint about both of its axes, the spherical joints of legs 1 to 3 against the
// angular velocity of the platform beside the leg. Coulomb friction builds up over 0.005 rad/s.
#include <optional>

#include "common/rubbing_joint.h"

namespace knee_robot::simulation {
namespace {

using mechanism::Vector3;

class PlatformJointFriction : public EffectOf<PlatformJointFriction> {
 public:
  explicit PlatformJointFriction(StrictMap& entry) : joint_(entry) {}
  void changePlant(PlantModel& model) override { mechanism_ = model.rigid.mechanism; }
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    mechanism::Motion motion;
    motion.pose = at.pose;
    motion.pose_velocity = at.pose_velocity;
    mechanism::RobotMotion robot;
    mechanism::robotMotion(*mechanism_, motion, robot);
    const Vector3 y = Vector3::UnitY(), normal = robot.platform.rotation.col(2);
    // Torque on the platform; its moments about Y and about its own normal are the generalized ones.
    Vector3 torque = joint_.resistance(at.pose_velocity[3]) * normal;
    const double about_y = joint_.resistance(at.pose_velocity[2] + robot.legs[3].rate[1]);
    for (std::size_t i = 0; i < 3; ++i) {
      const mechanism::LegMotion& leg = robot.legs[i];
      const Vector3 rate = robot.platform.omega + leg.rate[0] * y - leg.rate[1] * leg.n;
      const Vector3 resisting =
          rate.norm() > 0.0 ? Vector3(joint_.resistance(rate.norm()) / rate.norm() * rate) : Vector3::Zero();
      torque += resisting;
      loads.pose_force += leg.joints_per_pose.row(0).transpose() * y.dot(resisting) -
                          leg.joints_per_pose.row(1).transpose() * leg.n.dot(resisting);
    }
    loads.pose_force += about_y * robot.legs[3].joints_per_pose.row(1).transpose();
    loads.pose_force[2] += about_y + torque.dot(y);
    loads.pose_force[3] += torque.dot(normal);
  }

 private:
  RubbingJoint joint_;
  std::optional<mechanism::Mechanism> mechanism_;
};

}  // namespace

std::unique_ptr<Effect> makePlatformJointFriction(StrictMap& entry) {
  return std::make_unique<PlatformJointFriction>(entry);
}

}  // namespace knee_robot::simulation
