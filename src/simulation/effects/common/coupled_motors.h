#pragma once

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {

/// Elastic joint between motor and screw.
struct Coupling {
  mechanism::Vector4 actuators = mechanism::Vector4::Zero();  ///< 1: has it
  double stiffness_N_per_m = 0.0;
  double damping_N_s_per_m = 0.0;
  double half_gap_m = 0.0;  ///< free play to either side
};

/// Motors that move by themselves, joined to their screws elastically, with or without play: the rotor's mass is on the
/// motor's side, as is the encoder; friction and brakes are on the screw's side. The joint's force is taken at the end
/// of the substep (implicit), so that it is stable however stiff. Within the play nothing but a small viscous friction
/// holds the motor.
class CoupledMotors {
 public:
  explicit CoupledMotors(const Coupling& coupling) : coupling_(coupling) {}

  /// Takes the rotors out of the plant. InputError when an axis has none.
  void takeRotors(PlantModel& model);
  void start(const mechanism::Lengths& lengths) noexcept { position_ = lengths; }
  /// Replaces the motors' forces by the joints'.
  void push(const EffectStep& at, PlantLoads& loads) noexcept;
  void follow(const EffectStep& now) noexcept;
  /// Encoders see the motors.
  void replace(mechanism::Lengths& seen) const noexcept;

 private:
  Coupling coupling_;
  mechanism::Vector4 mass_ = mechanism::Vector4::Zero();
  mechanism::Vector4 position_ = mechanism::Vector4::Zero();
  mechanism::Vector4 velocity_ = mechanism::Vector4::Zero();
  mechanism::Vector4 motor_force_ = mechanism::Vector4::Zero();
  mechanism::Vector4 constant_ =
      mechanism::Vector4::Zero();  ///< joint's force = constant - slope * end velocity of the screw
  mechanism::Vector4 slope_ = mechanism::Vector4::Zero();
};

/// An effect that is nothing else.
template <typename Own>
class CoupledEffect : public EffectOf<Own> {
 public:
  explicit CoupledEffect(const Coupling& coupling) : motors_(coupling) {}
  void changePlant(PlantModel& model) override { motors_.takeRotors(model); }
  void start(const EffectStep& at) noexcept override { motors_.start(at.lengths); }
  void addLoads(const EffectStep& at, PlantLoads& loads) noexcept override { motors_.push(at, loads); }
  void follow(const EffectStep& now) noexcept override { motors_.follow(now); }
  void changeEncoders(mechanism::Lengths& seen) const noexcept override { motors_.replace(seen); }

 private:
  CoupledMotors motors_;
};

}  // namespace knee_robot::simulation
