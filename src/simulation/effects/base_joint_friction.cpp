// {name: base_joint_friction, coulomb_N_m: 1.5, viscous_N_m_s_per_rad: 2} Every joint between the base and a leg rubs
// alike: the universal joints of legs 1 to 3 about both of their axes, leg 4's revolute joint. Coulomb friction builds
// up over 0.005 rad/s.
#include <optional>

#include "common/rubbing_joint.h"

namespace knee_robot::simulation {
namespace {

class BaseJointFriction : public EffectOf<BaseJointFriction> {
 public:
  explicit BaseJointFriction(StrictMap& entry) : joint_(entry) {}
  void changePlant(PlantModel& model) override { mechanism_ = model.rigid.mechanism; }
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    mechanism::Motion motion;
    motion.pose = at.pose;
    motion.pose_velocity = at.pose_velocity;
    mechanism::RobotMotion robot;
    mechanism::robotMotion(*mechanism_, motion, robot);
    for (const mechanism::LegMotion& leg : robot.legs) {
      for (const int joint : {0, 1})  // leg 4 has no first one: its row is zero
        loads.pose_force += joint_.resistance(leg.rate[joint]) * leg.joints_per_pose.row(joint).transpose();
    }
  }

 private:
  RubbingJoint joint_;
  std::optional<mechanism::Mechanism> mechanism_;
};

}  // namespace

std::unique_ptr<Effect> makeBaseJointFriction(StrictMap& entry) {
  return std::make_unique<BaseJointFriction>(entry);
}

}  // namespace knee_robot::simulation
