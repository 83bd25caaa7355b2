// What acts on the platform or on all drives together is named on the simulated robot.
#include <cmath>

#include "test/tracing/simulated_recordings.h"

namespace knee_robot::tracing {
namespace {

/// Of legs 1 to 3: what leg 4 leaves is its stiction, seven times as much with nothing hidden.
double legs(const Eigen::VectorXd& error_N) {
  return error_N.head(3).norm();
}

TEST(Trace, NamesAMassThatSwingsOnThePlatformAndItsFrequency) {
  const TracedCase c = traceSimulated(
      "  - {name: wobbling_mass, mass_kg: 6, frequency_Hz: 0.8, damping_ratio: 0.1, point_m: [0, 0, 0], "
      "direction: [1, 0, 0]}\n");
  const FoundEffect* mass = foundIn(c, "wobbling_mass");
  ASSERT_NE(mass, nullptr);
  std::cout << "error " << c.before_N.transpose() << " -> " << c.after_N.transpose() << " N; frequency "
            << mass->hypothesis.shape[0] << " Hz, mass " << mass->coefficients[0] << " kg\n";
  EXPECT_NEAR(mass->hypothesis.shape[0], 0.8, 0.08);
  EXPECT_NEAR(mass->coefficients[0], 6.0, 0.6);
  EXPECT_LT(legs(c.after_N), 0.6 * legs(c.before_N));
}

TEST(Trace, NamesAMassThatHangsFromThePlatformItsMassAndItsFrequency) {
  const TracedCase c = traceSimulated(
      "  - {name: hanging_mass, mass_kg: 15, length_m: 0.25, damping_ratio: 0.03, point_m: [0.05, 0.1, -0.05]}\n");
  const FoundEffect* mass = foundIn(c, "hanging_mass");
  ASSERT_NE(mass, nullptr);
  const std::vector<double>& shape = mass->hypothesis.shape;
  std::cout << "error " << c.before_N.transpose() << " -> " << c.after_N.transpose() << " N; frequency " << shape[0]
            << " Hz, mass " << mass->coefficients[0] << " kg, pivot " << shape[2] << ' ' << shape[3] << ' ' << shape[4]
            << " m\n";
  EXPECT_NEAR(shape[0], std::sqrt(9.81 / 0.25) / (2.0 * 3.14159265), 0.03);
  EXPECT_NEAR(mass->coefficients[0], 15.0, 1.5);
  EXPECT_LT(legs(c.after_N), 0.6 * legs(c.before_N));
}

TEST(Trace, NamesTheFrictionOfTheJointsAtTheBase) {
  const TracedCase c = traceSimulated("  - {name: base_joint_friction, coulomb_N_m: 2, viscous_N_m_s_per_rad: 1}\n");
  const FoundEffect* friction = foundIn(c, "base_joint_friction");
  ASSERT_NE(friction, nullptr);
  std::cout << friction->coefficients.transpose() << " N m, N m s/rad; error " << c.before_N.transpose() << " -> "
            << c.after_N.transpose() << " N\n";
  EXPECT_NEAR(friction->coefficients[0], 2.0, 0.5);
  EXPECT_NEAR(friction->coefficients[2], 2.0, 0.5);
  EXPECT_LT(legs(c.after_N), 0.6 * legs(c.before_N));
}

TEST(Trace, NamesASupplyThatSagsWithAllDrives) {
  const TracedCase c = traceSimulated("  - {name: supply_sag, share: 0.4, half_at_N2: 20000, lag_s: 0.1}\n");
  const FoundEffect* sag = foundIn(c, "supply_sag");
  ASSERT_NE(sag, nullptr);
  std::cout << sag->coefficients[0] << " half at " << sag->hypothesis.shape[0] << " N^2, lag "
            << sag->hypothesis.shape[1] << " s, transfers " << sag->transfers << "; error " << c.before_N.transpose()
            << " -> " << c.after_N.transpose() << " N\n";
  EXPECT_LT(legs(c.after_N), 0.6 * legs(c.before_N));
}

TEST(Trace, TellsThatASupplyGivesTheDrivesWorkAsWell) {
  const TracedCase c =
      traceSimulated("  - {name: supply_sag, share: 0.6, half_at_N2: 100000, lag_s: 0.3, work_N2_per_W: 2000}\n");
  const FoundEffect* sag = foundIn(c, "supply_sag");
  ASSERT_NE(sag, nullptr);
  std::cout << "work " << sag->hypothesis.shape[2] << " N^2/W, lag " << sag->hypothesis.shape[1] << " s; error "
            << c.before_N.transpose() << " -> " << c.after_N.transpose() << " N\n";
  EXPECT_NEAR(sag->hypothesis.shape[2], 2000.0, 1000.0);
  EXPECT_NEAR(sag->hypothesis.shape[1], 0.3, 0.15) << "it counts the forces that are needed, not the larger commands";
  EXPECT_EQ(foundIn(c, "stretch_reflex"), nullptr) << "it passed for one before work was counted";
  EXPECT_LT(legs(c.after_N), 0.5 * legs(c.before_N));
}

TEST(Trace, NamesADriveThatGivesNothingForSmallCommands) {
  const TracedCase c = traceSimulated("  - {name: drive_dead_zone, actuators: [2], lost_N: 12}\n");
  const FoundEffect* zone = foundIn(c, "drive_dead_zone");
  ASSERT_NE(zone, nullptr);
  std::cout << "lost " << zone->coefficients[0] << " N; error " << c.before_N[1] << " -> " << c.after_N[1] << " N\n";
  EXPECT_EQ(zone->hypothesis.place.actuator, 1);
  EXPECT_NEAR(zone->coefficients[0], 12.0, 2.0);
  EXPECT_LT(c.after_N[1], 0.6 * c.before_N[1]);
}

TEST(Trace, NamesAMotorThatSaturates) {
  const TracedCase c = traceSimulated("  - {name: motor_saturation, actuators: [2], lost_at_100_N: 0.25}\n");
  const FoundEffect* saturation = foundIn(c, "motor_saturation");
  ASSERT_NE(saturation, nullptr);
  EXPECT_EQ(saturation->hypothesis.place.actuator, 1);
  // 50 N = u - 0.0025 / N u^2: u = 58.6 N
  const double told_more_at_50_N = saturation->coefficients[0] * std::pow(0.5, saturation->hypothesis.shape[0] - 1.0);
  std::cout << "told more by " << told_more_at_50_N << " at 50 N; error " << c.before_N[1] << " -> " << c.after_N[1]
            << " N\n";
  EXPECT_NEAR(told_more_at_50_N, 0.172, 0.04);
  EXPECT_LT(c.after_N[1], 0.8 * c.before_N[1]);  // without it leg 2 leaves as much as legs 1 and 3
}

TEST(Trace, NamesASpringThatRelaxesAlongAnActuator) {
  const TracedCase c =
      traceSimulated("  - {name: viscoelastic_element, actuators: [2], stiffness_N_per_m: 400, relaxation_s: 2}\n");
  const FoundEffect* element = foundIn(c, "viscoelastic_element");
  ASSERT_NE(element, nullptr);
  std::cout << "error " << c.before_N[1] << " -> " << c.after_N[1] << " N; relaxes in " << element->hypothesis.shape[0]
            << " and " << element->hypothesis.shape[1] << " s\n";
  EXPECT_EQ(element->hypothesis.place.actuator, 1);
  EXPECT_NEAR(element->coefficients[0], 400.0, 80.0);
}

}  // namespace
}  // namespace knee_robot::tracing
