#pragma once

#include "knee_robot/simulation/robot_simulation.h"

namespace knee_robot::simulation {

/// A hand that takes the platform along a path as hands do: not by its place but by a spring and a damper, and never
/// harder than it can.
/// Its force acts through the image's surroundings. Not part of the robot.
class SimulatedHand {
 public:
  /// Spring and damper between hand and platform, and the most that the hand pushes.
  struct Impedance {
    double stiffness_N_per_m = 2000.0, damping_N_s_per_m = 100.0, largest_N = 150.0;
    double lever_m = 0.2;  ///< angles count as much as lengths of this lever
  };
  SimulatedHand(RobotImage& image, const Impedance& impedance) : image_(image), impedance_(impedance) {}

  /// Pulls towards `wanted`, which moves with `velocity`. Real-time safe.
  void pull(const PlantState& now, const mechanism::Pose& wanted, const mechanism::Vector4& velocity) noexcept;
  void letGo() noexcept;
  /// Of the last pull, on Xm and Zm together, N; moments count by the lever.
  double force_N() const noexcept { return force_N_; }

 private:
  RobotImage& image_;
  const Impedance impedance_;
  double force_N_ = 0.0;
};

}  // namespace knee_robot::simulation
