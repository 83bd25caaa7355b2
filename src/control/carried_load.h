#pragma once

#include "knee_robot/control/axis_data.h"

namespace knee_robot::control {

/// What carries one axis where it is, should its loop fail, the process die, or nobody see the platform any more: the
/// model's whole weight here, whatever share of it is fed forward, and what was needed beside it. A mean over a second
/// of motion would be behind the weight that changes with the pose.
///
/// What is needed beside it is estimated with the friction that no model foresees (a Kalman filter of two states, both
/// of which wander): in motion friction is added by the direction; at rest it may hide as much of the load, so that
/// what an axis stands with holds it there, but says little about another place.
class CarriedLoad {
 public:
  /// The Drivers take over: the feedforward is in the command, and nothing else is known.
  void begin(const AxisCommand& command) noexcept;
  /// Where a payload is declared the model foresees weight that was carried before: the sum stays.
  void follow(const AxisCommand& command) noexcept;
  /// One cycle of dt seconds in which the drive gave `given_N`, the axis was at `position_m`, and no brake carried.
  void learn(const AxisCommand& command, double given_N, double position_m, double dt) noexcept;

  /// A part of what nobody foresaw is the weight of so much more on the platform: the sum stays, and goes with the place.
  void addMass(double kg, double per_kg_N) noexcept;
  double beside_N() const noexcept { return beside_N_; }
  /// At rest, away from where it had settled: another force carries it than before. What pushes one axis pushes all.
  bool isPushed() const noexcept { return pushed_; }
  void learnAnew() noexcept;
  /// It is known what it weighs here: by a model, or from standing.
  bool isWeighed() const noexcept { return weight_N_ != 0.0; }
  /// N, what the drive has given lately.
  double lately_N() const noexcept { return lately_N_; }
  /// N, what carries the axis at rest: what does so, if it has stood for a while.
  double atRest_N() const noexcept;

 private:
  void correct(const AxisCommand& command, double seen_N, double dt) noexcept;

  double lately_N_ = 0.0;
  double weight_N_ = 0.0;    // that the model foresees
  double beside_N_ = 0.0;    // that nobody foresaw
  double friction_N_ = 0.0;  // likewise, in the direction of motion
  double variance_ = 0.0, friction_variance_ = 0.0, covariance_ = 0.0;
  double declared_N_ = 0.0;
  double more_kg_ = 0.0, per_kg_N_ = 0.0;  // on the platform, that nobody declared; what a kilogram weighs here
  bool pushed_ = false;
  double stood_s_ = 0.0, settled_s_ = 0.0, pushed_s_ = 0.0;
};

}  // namespace knee_robot::control
