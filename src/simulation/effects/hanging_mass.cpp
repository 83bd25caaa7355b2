// {name: hanging_mass, mass_kg: 3, length_m: 0.25, damping_ratio: 0.03, point_m: [0, 0.05, -0.03]}
// A mass that hangs from a point of the platform by a nearly rigid rod and swings to all sides: a bag, a hose, a limb in a
// sling. Any angle below the horizontal.
#include <cmath>

#include "knee_robot/base/constants.h"
#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

constexpr double kAlong_per_s = kTwoPi * 20.0, kDampingAlong = 0.7;

class HangingMass : public EffectOf<HangingMass> {
 public:
  explicit HangingMass(StrictMap& entry)
      : mass_kg_(entry.number("mass_kg", 0.0, 100.0)),
        length_m_(entry.number("length_m", 0.02, 5.0)),
        damping_ratio_(entry.number("damping_ratio", 0.0, 2.0)),
        point_m_(readVector3(entry, "point_m", -2.0, 2.0)) {}
  void changePlant(PlantModel& model) override {
    gravity_ = model.rigid.gravity;
    damping_per_s_ = 2.0 * damping_ratio_ * std::sqrt(gravity_.norm() / length_m_);
  }
  void start(const EffectStep& at) noexcept override {
    velocity_m_per_s_ = velocityOfPivot(at);
    const double stretched_m = gravity_.norm() / (kAlong_per_s * kAlong_per_s);
    hangs_m_ = (length_m_ + stretched_m) * gravity_.normalized();
    rate_m_per_s_.setZero();
  }
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override {
    loads.pose_force += poseForceOf(at.pose, point_m_, mass_kg_ * pull());
  }
  void follow(const EffectStep& now) noexcept override {
    const mechanism::Vector3 velocity = velocityOfPivot(now);
    const mechanism::Vector3 support = (velocity - velocity_m_per_s_) / now.dt_s;
    velocity_m_per_s_ = velocity;
    rate_m_per_s_ += now.dt_s * (gravity_ - support - pull());
    hangs_m_ += now.dt_s * rate_m_per_s_;
  }

 private:
  /// On the platform, per kilogram, base frame; its opposite is on the mass.
  mechanism::Vector3 pull() const noexcept {
    const mechanism::Vector3 along = hangs_m_.normalized();
    const double stretching = along.dot(rate_m_per_s_);
    const double rod =
        kAlong_per_s * kAlong_per_s * (hangs_m_.norm() - length_m_) + 2.0 * kDampingAlong * kAlong_per_s * stretching;
    return rod * along + damping_per_s_ * (rate_m_per_s_ - stretching * along);
  }
  mechanism::Vector3 velocityOfPivot(const EffectStep& at) const noexcept {
    mechanism::Vector3 velocity;
    for (int k = 0; k < 3; ++k)
      velocity[k] = poseForceOf(at.pose, point_m_, mechanism::Vector3::Unit(k)).dot(at.pose_velocity);
    return velocity;
  }

  double mass_kg_, length_m_, damping_ratio_, damping_per_s_ = 0.0;
  mechanism::Vector3 point_m_, gravity_ = mechanism::Vector3(0.0, 0.0, -9.81);
  mechanism::Vector3 hangs_m_ = mechanism::Vector3::Zero();  ///< from the pivot, base frame
  mechanism::Vector3 rate_m_per_s_ = mechanism::Vector3::Zero(), velocity_m_per_s_ = mechanism::Vector3::Zero();
};

}  // namespace

std::unique_ptr<Effect> makeHangingMass(StrictMap& entry) {
  return std::make_unique<HangingMass>(entry);
}

}  // namespace knee_robot::simulation
