#pragma once

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {

/// All effects of a simulated robot, in the order in which they act.
class EffectChain {
 public:
  /// Copies the prototypes and lets each of them change `model`.
  EffectChain(const EffectPrototypes& prototypes, PlantModel& model);

  bool empty() const noexcept { return effects_.empty(); }
  /// The plant stands at `state`.
  void start(const PlantModel& model, const PlantState& state);

  /// stepPlant with effects. `loads` holds the commanded motor forces, the axes' own friction and forces on the pose;
  /// `holds` the friction of brakes and shorted windings; `driven` is 1 where a drive is on: without it no effect
  /// exerts a motor force.
  /// Real-time safe.
  bool step(const PlantModel& model, const PlantLoads& loads, const PlantLoads& holds, const mechanism::Vector4& driven,
            double dt, PlantState& state, PlantData& data) noexcept;

  /// What the encoders see at these lengths.
  mechanism::Lengths encoders(mechanism::Lengths lengths) const noexcept;
  /// What acted on the plant during the last substep.
  const PlantLoads& acted() const noexcept { return acted_; }
  /// Mean over the last step of the command (N, per leg) less what a robot without effects would need for the same
  /// motion. At rest dry friction takes what it can, or what a law near rest says (Effect::dryFriction): how friction
  /// comes up from rest belongs to that robot, too. A rotor behind a coupling or a play counts as an effect.
  const mechanism::Vector4& unmodelled() const noexcept { return unmodelled_; }

 private:
  std::vector<std::unique_ptr<Effect>> effects_;
  EffectStep at_;
  PlantLoads acted_;
  mechanism::Vector4 unmodelled_ = mechanism::Vector4::Zero();
};

}  // namespace knee_robot::simulation
