#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "knee_robot/base/strict_yaml.h"
#include "knee_robot/simulation/plant.h"

namespace knee_robot::simulation {

/// Where the plant is at the beginning (or end) of a substep.
struct EffectStep {
  double time_s = 0.0;  ///< since the simulation began
  double dt_s = 0.0;    ///< of the substep
  mechanism::Pose pose = mechanism::Pose::Zero();
  mechanism::Vector4 pose_velocity = mechanism::Vector4::Zero();
  mechanism::Lengths lengths = mechanism::Lengths::Zero();
  mechanism::Vector4 rates = mechanism::Vector4::Zero();  ///< m/s, of the lengths
  mechanism::Vector4 transmitted_N =
      mechanism::Vector4::Zero();  ///< force that each leg passes on to the mechanism, last substep
};

/// Something that the simulated robot has and its model does not: one physical deviation from rigid links, constant
/// Coulomb and viscous friction, ideal drives and ideal encoders. Each effect is one file in src/simulation/effects/
/// and says there what it does and how it is configured. Effects act in the order of the simulation file. Everything
/// but changePlant is real-time safe.
class Effect {
 public:
  virtual ~Effect() = default;
  virtual std::unique_ptr<Effect> clone() const = 0;

  /// Once, before the simulation begins. May throw InputError.
  virtual void changePlant(PlantModel& /*model*/) {}
  /// Once, when the plant stands at its start.
  virtual void start(const EffectStep& /*at*/) noexcept {}
  /// Every simulated period of `dt_s`: between the drives' command and the motors (N).
  virtual void changeForce(double /*dt_s*/, mechanism::Vector4& /*motor_force*/) noexcept {}
  /// Every substep, first of all: levels of Coulomb and viscous friction. Brakes come later and are not in `loads`.
  virtual void changeFriction(const EffectStep& /*at*/, PlantLoads& /*loads*/) noexcept {}
  /// Every substep, when all friction levels are known: forces.
  virtual void addLoads(const EffectStep& /*at*/, PlantLoads& /*loads*/) noexcept {}
  /// Every substep, when the plant has moved: states of its own.
  virtual void follow(const EffectStep& /*now*/) noexcept {}
  /// Dry friction (N) of axis `leg` over the last substep, which began at `rate` and ended at `rate_after` (m/s), if its
  /// Coulomb level were `level_N`. An effect that says how friction comes up from rest answers for its own law; others
  /// leave `friction_N`. Called before follow().
  virtual double dryFriction(int /*leg*/, double /*level_N*/, double /*rate*/, double /*rate_after*/,
                             double friction_N) const noexcept {
    return friction_N;
  }
  /// What the encoders are fixed to, in place of the lengths (m).
  virtual void changeEncoders(mechanism::Lengths& /*seen*/) const noexcept {}
};

/// Base of a concrete effect; supplies clone().
template <class Self>
class EffectOf : public Effect {
 public:
  std::unique_ptr<knee_robot::simulation::Effect> clone() const override {
    return std::make_unique<Self>(static_cast<const Self&>(*this));
  }
};

using EffectPrototypes = std::vector<std::shared_ptr<const Effect>>;

/// Names of all effects: the files of src/simulation/effects/ (the build collects them).
std::vector<std::string> effectNames();
/// One entry of a simulation file's `effects`: `name` and the parameters of that effect. InputError (file, line,
/// limit).
std::shared_ptr<const Effect> readEffect(StrictMap& entry);

/// How one file makes its effect; make<Name> of src/simulation/effects/<name>.cpp.
using EffectMaker = std::unique_ptr<Effect> (*)(StrictMap& entry);
/// An effect as simulation files name it.
struct NamedEffectMaker {
  const char* name;
  EffectMaker make;
};
/// Written by the build.
const std::vector<NamedEffectMaker>& effectMakers();

/// Optional key `actuators`: [1, 4] and the like, all four by default. 1 for those that are named, else 0.
mechanism::Vector4 readActuators(StrictMap& entry);
/// A key with three numbers.
mechanism::Vector3 readVector3(StrictMap& entry, const std::string& key, double minimum, double maximum);
/// Generalized force on the pose coordinates of `force` (N, base frame) on the platform's `point` (m, platform frame).
mechanism::Vector4 poseForceOf(const mechanism::Pose& pose, const mechanism::Vector3& point,
                               const mechanism::Vector3& force) noexcept;
/// The platform's `point` (m, platform frame) in the base frame.
mechanism::Vector3 platformPoint(const mechanism::Pose& pose, const mechanism::Vector3& point) noexcept;

}  // namespace knee_robot::simulation
