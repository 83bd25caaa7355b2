// What a periodic thread calls must not allocate: every operator new of this program is counted.
#include <gtest/gtest.h>

#include <cmath>
#include <new>

#include "knee_robot/simulation/robot_simulation.h"
#include "knee_robot/simulation/simulated_cards.h"
#include "test/allocation_guard.h"
#include "test/simulation/plant_bench.h"

namespace knee_robot::simulation {
namespace {

TEST(RealTimePath, OfBusAndPlantAllocatesNothing) {
  const mechanism::Robot robot = configuredRobot("A");
  const auto parameters = loadSimulationParameters(std::string(KNEE_SOURCE_DIR) + "/config/simulation/A.yaml");
  RobotImage image;
  RobotSimulation simulation(robot, dynamics::loadRobotInertia(robot), parameters, image);
  const auto bus = openImageCards(image);
  ASSERT_TRUE(bus->selfTest().passed);
  armed = true;
  operator delete(operator new(8));
  ASSERT_GT(allocations, 0) << "the counter counts";
  allocations = 0;
  hardware::AxisFeedback feedback;
  std::array<double, 4> written{};
  bool good = bus->writeOutputs(3) == hardware::IoStatus::Ok;
  for (int i = 0; i < 300; ++i) {  // falls, is pushed about, rests on its stops
    good = good && bus->read(feedback) == hardware::IoStatus::Ok;
    good =
        good && bus->writeVolts({std::sin(0.05 * i), 1.0, std::cos(0.03 * i), 2.0}, written) == hardware::IoStatus::Ok;
    good = good && simulation.step(1e-3);
  }
  good = good && bus->writeVolts({NAN, 0, 0, 0}, written) == hardware::IoStatus::NotFinite;
  armed = false;
  EXPECT_EQ(allocations, 0);
  EXPECT_TRUE(good);
}

TEST(RealTimePath, OfAllEffectsAllocatesNothing) {
  const mechanism::Robot robot = configuredRobot("final");
  const auto parameters = parseSimulationParameters(R"(
axes: [{viscous_N_s_per_m: 150, coulomb_N: 15}]
effects:
  - {name: asymmetric_coulomb, difference_N: 4}
  - {name: asymmetric_viscous, difference_N_s_per_m: 40}
  - {name: stribeck, excess_N: 5, velocity_m_per_s: 0.01}
  - {name: load_dependent_friction, share: 0.05}
  - {name: position_dependent_friction, amplitude_N: 5, center_m: 0.7, width_m: 0.01}
  - {name: quadratic_drag, drag_N_s2_per_m2: 300}
  - {name: screw_whirl, peak_N: 5, critical_m_per_s: 0.05, at_length_m: 0.7, width_m_per_s: 0.01}
  - {name: thermal_drift, coulomb_change: -0.2, time_constant_s: 5}
  - {name: frictional_ageing, excess_N: 5, time_constant_s: 2, way_m: 0.006}
  - {name: reversal_friction, excess_N: 5, way_m: 0.01, rise_m: 0.001}
  - {name: viscoelastic_element, stiffness_N_per_m: 100, relaxation_s: 2}
  - {name: supply_sag, share: 0.1, half_at_N2: 20000, lag_s: 0.1}
  - {name: wobbling_mass, mass_kg: 1, frequency_Hz: 2, damping_ratio: 0.1, point_m: [0, 0, 0.1], direction: [1, 0, 0]}
  - {name: hanging_mass, mass_kg: 1, length_m: 0.2, damping_ratio: 0.05, point_m: [0, 0, -0.1]}
  - {name: presliding, actuators: [1], stiffness_N_per_m: 5e5}
  - {name: screw_ripple, amplitude_N: 3, period_m: 0.01}
  - {name: payload, mass_kg: 2, center_m: [0, 0, 0.1]}
  - {name: base_tilt, about_x_deg: 1}
  - {name: reflected_inertia, mass_kg: 1}
  - {name: spring, stiffness_N_per_m: 100, anchor_m: [0, 0, 0], point_m: [0.1, 0, 0]}
  - {name: passive_joint, coordinate: theta, width_rad: 0.1, towards_positive_Nm: 1, towards_negative_Nm: 1, yield_Nm: 1}
  - {name: one_sided_spring, force_at_0.1_m_N: 50, anchor_m: [0, 0, 2], point_m: [0.1, 0, 0], acts_from_m: 1, side: longer}
  - {name: viscoelastic_link, stiffness_N_per_m: 100, relaxation_s: 1, anchor_m: [0, 0, 0], point_m: [0.1, 0, 0]}
  - {name: elastoplastic_link, yield_N: 10, yield_m: 0.004, anchor_m: [0, 0, 0], point_m: [0.1, 0, 0]}
  - {name: line_friction, friction_N: 10, proportional_below_m_per_s: 0.004, anchor_m: [0, 0, 1.8], point_m: [0.1, 0, 0]}
  - {name: link_between_legs, first_leg: 1, second_leg: 2, between: rods, acts_from_m: 0.1, side: longer, stiffness_N_per_m: 50, friction_N: 1}
  - {name: external_force, start_s: 0.1, end_s: 0.2, force_N: [0, 0, -20], point_m: [0, 0, 0]}
  - {name: force_gain, factor: 0.95}
  - {name: drive_dead_zone, lost_N: 1}
  - {name: idle_current_reduction, actuators: [4], cut: 0.1}
  - {name: motor_saturation, lost_at_100_N: 0.02}
  - {name: force_offset, force_N: 2}
  - {name: delay, time_s: 0.002}
  - {name: drive_lag, time_constant_s: 0.003}
  - {name: flexible_coupling, actuators: [2], stiffness_N_per_m: 2e5}
  - {name: backlash, actuators: [3], width_m: 0.0002}
  - {name: near_rest_friction, law: lugre, distance_m: 0.0001}
  - {name: neighbour_seal, actuators: [2], friction_N: 3, neighbour: 1, center_m: 0.7, width_m: 0.02}
  - {name: load_ripple, share: 0.05, period_m: 0.01}
  - {name: platform_joint_friction, coulomb_N_m: 0.5, viscous_N_m_s_per_rad: 1}
  - {name: base_joint_friction, coulomb_N_m: 0.5, viscous_N_m_s_per_rad: 1}
)",
                                                    "all.yaml");
  ASSERT_EQ(parameters.effects.size(), effectNames().size());  // every effect of the folder is here
  RobotImage image;
  RobotSimulation simulation(robot, dynamics::loadRobotInertia(robot), parameters, image);
  const auto bus = openImageCards(image);
  ASSERT_TRUE(bus->selfTest().passed);
  allocations = 0;
  armed = true;
  std::array<double, 4> written{};
  bool good = bus->writeOutputs(3) == hardware::IoStatus::Ok;
  for (int i = 0; i < 400; ++i) {
    good =
        good && bus->writeVolts({std::sin(0.05 * i), 0.5, std::cos(0.03 * i), 1.0}, written) == hardware::IoStatus::Ok;
    good = good && simulation.step(1e-3);
  }
  armed = false;
  EXPECT_EQ(allocations, 0);
  EXPECT_TRUE(good);
}

}  // namespace
}  // namespace knee_robot::simulation
