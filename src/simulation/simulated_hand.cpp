#include "knee_robot/simulation/simulated_hand.h"

#include <algorithm>

namespace knee_robot::simulation {

void SimulatedHand::pull(const PlantState& now, const mechanism::Pose& wanted,
                         const mechanism::Vector4& velocity) noexcept {
  // Everything in newtons and metres at the lever.
  const mechanism::Vector4 scale(1.0, 1.0, impedance_.lever_m, impedance_.lever_m);
  mechanism::Vector4 force = impedance_.stiffness_N_per_m * scale.cwiseProduct(wanted - now.pose) +
                             impedance_.damping_N_s_per_m * scale.cwiseProduct(velocity - now.pose_velocity);
  const double size = force.norm();
  if (size > impedance_.largest_N) force *= impedance_.largest_N / size;
  force_N_ = std::min(size, impedance_.largest_N);
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    image_.surroundings.pose_force[i].store(scale[static_cast<Eigen::Index>(i)] * force[static_cast<Eigen::Index>(i)]);
}

void SimulatedHand::letGo() noexcept {
  for (auto& force : image_.surroundings.pose_force)
    force.store(0.0);
  force_N_ = 0.0;
}

}  // namespace knee_robot::simulation
