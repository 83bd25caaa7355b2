#include "coupled_motors.h"

#include <cmath>

#include "knee_robot/base/errors.h"

namespace knee_robot::simulation {
namespace {

constexpr double kBearingViscous = 20.0;  ///< N s/m: viscous friction of a motor by itself

}  // namespace

void CoupledMotors::takeRotors(PlantModel& model) {
  for (int i = 0; i < mechanism::kLegs; ++i) {
    if (coupling_.actuators[i] == 0.0) continue;
    mass_[i] = model.rigid.rotor_mass[i];
    model.rigid.rotor_mass[i] = 0.0;
    if (mass_[i] > 0.0) continue;
    throw InputError(
        "actuator " + std::to_string(i + 1) +
        " has a flexible coupling or backlash but no rotor of its own; give it a rotor_mass_kg above 0, and "
        "only one of the two effects");
  }
}

void CoupledMotors::push(const EffectStep& at, PlantLoads& loads) noexcept {
  const double h = at.dt_s;
  const double both = coupling_.stiffness_N_per_m * h + coupling_.damping_N_s_per_m;
  for (int i = 0; i < mechanism::kLegs; ++i) {
    if (coupling_.actuators[i] == 0.0) continue;
    motor_force_[i] = loads.motor_force[i] - kBearingViscous * velocity_[i];
    const double free_velocity = velocity_[i] + h * motor_force_[i] / mass_[i];
    const double wound = position_[i] - at.lengths[i];
    const double ahead = wound + h * (free_velocity - at.rates[i]);
    constant_[i] = slope_[i] = 0.0;
    if (std::abs(ahead) >= coupling_.half_gap_m) {
      const double inside = wound - std::copysign(coupling_.half_gap_m, ahead);
      const double share = 1.0 / (1.0 + both * h / mass_[i]);
      const double constant = share * (coupling_.stiffness_N_per_m * inside + both * free_velocity);
      const double slope = share * both;
      const bool pulls = (constant - slope * at.rates[i]) * ahead < 0.0;  // stops of a play push only
      if (coupling_.half_gap_m == 0.0 || !pulls) {
        constant_[i] = constant;
        slope_[i] = slope;
      }
    }
    // The plant's viscous friction takes the mean of start and end velocity; this brings it to the end's.
    loads.motor_force[i] = constant_[i] + slope_[i] * at.rates[i];
    loads.viscous[i] += 2.0 * slope_[i];
  }
}

void CoupledMotors::follow(const EffectStep& now) noexcept {
  for (int i = 0; i < mechanism::kLegs; ++i) {
    if (coupling_.actuators[i] == 0.0) continue;
    const double joint = constant_[i] - slope_[i] * now.rates[i];
    velocity_[i] += now.dt_s * (motor_force_[i] - joint) / mass_[i];
    position_[i] += now.dt_s * velocity_[i];
  }
}

void CoupledMotors::replace(mechanism::Lengths& seen) const noexcept {
  for (int i = 0; i < mechanism::kLegs; ++i) {
    if (coupling_.actuators[i] != 0.0) seen[i] = position_[i];
  }
}

}  // namespace knee_robot::simulation
