#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "knee_robot/dynamics/effect_law.h"
#include "knee_robot/dynamics/friction_law.h"
#include "knee_robot/dynamics/parameters.h"
#include "knee_robot/mechanism/robot.h"

namespace knee_robot::dynamics {

struct Model;

inline constexpr int kMostActingEffects = 64;
/// Largest share of its command that a drive may fail to give (force_gain) in a model that is fed forward: beyond it the
/// command would be more than five times the force.
inline constexpr double kMostForceGain = 0.8;

/// An effect of a model at its place, with its numbers.
struct ActingEffect {
  std::shared_ptr<const EffectLaw> law;
  int actuator = -1;  ///< -1: shared
  EffectColumns coefficients{};
};

/// An effect that a force instant by instant is without.
struct LeftOutEffect {
  std::string name;    ///< as in the model file, of an unnamed one with its signal
  std::string where;   ///< "axis 2", "the platform"
  std::string reason;  ///< half a sentence
};

/// What effects see of the baseline: the model's numbers `effects_see`, apart for what the screw carries and what rubs.
struct EffectsSee {
  ExtendedParameters load = ExtendedParameters::Zero(), rubbing = ExtendedParameters::Zero();
  mechanism::Matrix4 axis_load = mechanism::Matrix4::Zero(), axis_rubbing = mechanism::Matrix4::Zero();
  mechanism::Vector4 coulomb = mechanism::Vector4::Zero();  ///< N; in none of the others
};

/// The effects of a model file as constants. Effects that belong to one recording, or that only a whole recording
/// shows, are left out by name; where the file has numbers for a controller, or `elsewhere`, those count, because a
/// running robot is no training recording.
struct ActingEffects {
  ActingEffects() = default;
  /// InputError when an effect is unknown, or its numbers are not that effect's, or a gain is above kMostForceGain.
  ActingEffects(const Model& model, const mechanism::Robot& robot);

  std::vector<ActingEffect> acting;  ///< that are carried or rub
  std::vector<LeftOutEffect> left_out;
  mechanism::Vector4 gain = mechanism::Vector4::Zero();     ///< per actuator: share of the whole force (force_gain)
  mechanism::Vector4 ahead_s = mechanism::Vector4::Zero();  ///< per actuator: delay and drive lag
  mechanism::Vector4 turn_m = mechanism::Vector4::Zero();   ///< a shorter way back is no reversal
  EffectsSee see;

  bool any() const { return !acting.empty() || !gain.isZero(0.0) || !ahead_s.isZero(0.0); }
  /// How far ahead the force has to be known, s.
  double horizon() const { return ahead_s.cwiseAbs().maxCoeff(); }
};

/// Follows the turning points of a path that is told by its steps. Real-time safe.
class ReversalTracker {
 public:
  /// A way back of at most `turn_m` is no reversal.
  SinceReversal step(double displacement_m, double period_s, double turn_m) noexcept;

 private:
  void turn() noexcept;
  void closeLoops() noexcept;

  static constexpr std::size_t kMostTurns = 32;  ///< of loops within loops; the oldest is forgotten
  std::array<double, kMostTurns> turns_{};       ///< where the path began is one, until a stroke passes it
  std::size_t size_ = 1;
  double at_ = 0.0, extreme_ = 0.0, direction_ = 0.0, turned_last_ = 0.0;
  double since_turn_s_ = 0.0, since_extreme_s_ = 0.0;
  bool turned_ = false;
};

/// What remembers the motion: friction near rest, turning points, the effects' own states. Copying it does not
/// allocate.
struct MotionMemory {
  std::array<FrictionState, mechanism::kLegs> friction;
  std::array<ReversalTracker, mechanism::kLegs> turned;
  std::array<EffectState, kMostActingEffects> effects{};
  mechanism::Vector4 acceleration = mechanism::Vector4::Zero(), jerk = mechanism::Vector4::Zero();
  bool moved = false;

  /// The jerk is what acceleration changes by, low-passed: a reference comes in segments of constant acceleration.
  void follow(const mechanism::Vector4& now, double period_s) noexcept;
};

/// One instant of a motion for effectForces; arrays per actuator, as in EffectInstant.
struct EffectsInstant {
  double period_s = 0.0;
  mechanism::Vector4 position_m = mechanism::Vector4::Zero(), velocity_m_per_s = mechanism::Vector4::Zero();
  mechanism::Vector4 displacement_m = mechanism::Vector4::Zero(), share = mechanism::Vector4::Zero();
  mechanism::Vector4 load_N = mechanism::Vector4::Zero(), fade = mechanism::Vector4::Ones();
  const mechanism::Mechanism* mechanism = nullptr;      ///< null: bench axes, as the next
  const mechanism::Motion* motion = nullptr;            ///< of the platform
  const mechanism::Matrix4* pose_per_length = nullptr;  ///< J^-1
};

/// Forces (N) of the effects, without gain and without what is ahead.
struct EffectForces {
  mechanism::Vector4 carried = mechanism::Vector4::Zero(), friction = mechanism::Vector4::Zero();
  mechanism::Vector4 sum() const { return carried + friction; }
};

/// One step of all effects. Real-time safe.
EffectForces effectForces(const ActingEffects& effects, int axes, const EffectsInstant& at,
                          MotionMemory& memory) noexcept;

/// The drives were off for so long: friction starts anew, and what was warm cools. Real-time safe.
void rest(const ActingEffects& effects, double duration_s, MotionMemory& memory) noexcept;

}  // namespace knee_robot::dynamics
