// {name: wobbling_mass, mass_kg: 4, frequency_Hz: 1.5, damping_ratio: 0.1, point_m: [0, 0.05, 0.1], direction: [1, 0, 0]}
// A mass that springs and dampers hold to a point of the platform: softly along one direction of the platform (soft
// tissue, liquid in a tank), nearly rigidly across it.
#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

constexpr double kAcross_per_s = kTwoPi * 20.0, kDampingAcross = 0.7;

class WobblingMass : public EffectOf<WobblingMass> {
 public:
  explicit WobblingMass(StrictMap& entry)
      : mass_kg_(entry.number("mass_kg", 0.0, 100.0)), point_m_(readVector3(entry, "point_m", -2.0, 2.0)) {
    const double omega = kTwoPi * entry.number("frequency_Hz", 0.1, 20.0);
    const double damping = entry.number("damping_ratio", 0.0, 2.0);
    mechanism::Vector3 direction = readVector3(entry, "direction", -1.0, 1.0);
    if (direction.norm() < 1e-3)
      entry.refuse("direction", "is zero; give the direction in which the mass moves, like [1, 0, 0]");
    direction.normalize();
    const mechanism::Matrix3 along = direction * direction.transpose();
    const mechanism::Matrix3 across = mechanism::Matrix3::Identity() - along;
    stiffness_ = omega * omega * along + kAcross_per_s * kAcross_per_s * across;
    damping_ = 2.0 * damping * omega * along + 2.0 * kDampingAcross * kAcross_per_s * across;
  }
  void changePlant(PlantModel& model) override { gravity_ = model.rigid.gravity; }
  void start(const EffectStep& at) noexcept override {
    const mechanism::Matrix3 rotation = mechanism::platformRotation(at.pose);
    velocity_m_per_s_ = velocityOfPoint(at);
    displacement_m_ = stiffness_.inverse() * (rotation.transpose() * gravity_);
  }
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    const mechanism::Vector3 pull = mass_kg_ * (stiffness_ * displacement_m_ + damping_ * rate_m_per_s_);
    const mechanism::Matrix3 rotation = mechanism::platformRotation(at.pose);
    loads.pose_force += poseForceOf(at.pose, point_m_ + displacement_m_, rotation * pull);
  }
  void follow(const EffectStep& now) noexcept override {
    const mechanism::Vector3 velocity = velocityOfPoint(now);
    const mechanism::Vector3 support = (velocity - velocity_m_per_s_) / now.dt_s;
    velocity_m_per_s_ = velocity;
    const mechanism::Matrix3 rotation = mechanism::platformRotation(now.pose);
    rate_m_per_s_ += now.dt_s * (rotation.transpose() * (gravity_ - support) - stiffness_ * displacement_m_ -
                                 damping_ * rate_m_per_s_);
    displacement_m_ += now.dt_s * rate_m_per_s_;
  }

 private:
  mechanism::Vector3 velocityOfPoint(const EffectStep& at) const noexcept {
    mechanism::Vector3 velocity;
    for (int k = 0; k < 3; ++k)
      velocity[k] = poseForceOf(at.pose, point_m_, mechanism::Vector3::Unit(k)).dot(at.pose_velocity);
    return velocity;
  }

  double mass_kg_;
  mechanism::Vector3 point_m_, gravity_ = mechanism::Vector3(0.0, 0.0, -9.81);
  mechanism::Matrix3 stiffness_, damping_;  ///< per kilogram, in the platform's frame
  mechanism::Vector3 displacement_m_ = mechanism::Vector3::Zero(), rate_m_per_s_ = mechanism::Vector3::Zero();
  mechanism::Vector3 velocity_m_per_s_ = mechanism::Vector3::Zero();
};

}  // namespace

std::unique_ptr<Effect> makeWobblingMass(StrictMap& entry) {
  return std::make_unique<WobblingMass>(entry);
}

}  // namespace knee_robot::simulation
