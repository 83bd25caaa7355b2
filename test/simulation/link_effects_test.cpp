// What is tied to the platform and remembers its way: by hand-worked numbers, without a robot.
#include <gtest/gtest.h>

#include <cmath>

#include "knee_robot/simulation/effect.h"

namespace knee_robot::simulation {
namespace {

constexpr double kSubstep_s = 0.00025;

std::unique_ptr<Effect> effectOf(const std::string& entry) {
  StrictMap map = StrictMap::parse(entry, "test.yaml");
  return readEffect(map)->clone();
}

/// The platform where a line from the base's X = 0.3 m to its middle is 0.5 m long and points 0.6 back and 0.8 up.
EffectStep leaning() {
  EffectStep at;
  at.dt_s = kSubstep_s;
  at.pose = mechanism::Pose(0.0, 0.4, 0.0, 0.0);
  return at;
}
const char* const kPoints = ", anchor_m: [0.3, 0, 0], point_m: [0, 0, 0]}";

/// Generalized force on the pose at this step.
mechanism::Vector4 pushed(Effect& effect, const EffectStep& at) {
  PlantLoads loads;
  effect.addLoads(at, loads);
  return loads.pose_force;
}

/// As if it went up at this speed on the spot, along which the line's rate is 0.8 of it.
void rise(Effect& effect, double speed_m_per_s, double seconds) {
  EffectStep now = leaning();
  now.pose_velocity[1] = speed_m_per_s;
  for (int n = 0; n < std::lround(seconds / kSubstep_s); ++n)
    effect.follow(now);
}

TEST(ViscoelasticLink, IsStretchedByTheLinesRateAndRelaxesWithItsTime) {
  const auto link =
      effectOf("{name: viscoelastic_link, stiffness_N_per_m: 1000, relaxation_s: 2" + std::string(kPoints));
  EXPECT_TRUE(pushed(*link, leaning()).isZero(0.0)) << "it begins relaxed";
  rise(*link, 0.05, 1.0);
  const double stretched_m = 0.8 * 0.05 * 2.0 * (1.0 - std::exp(-0.5));
  const mechanism::Vector4 along(-0.6, 0.8, 0.0, 0.0);
  EXPECT_TRUE(pushed(*link, leaning()).isApprox(-1000.0 * stretched_m * along, 1e-9));
  rise(*link, 0.0, 4.0);
  EXPECT_TRUE(pushed(*link, leaning()).isApprox(-1000.0 * stretched_m * std::exp(-2.0) * along, 1e-9));
}

TEST(ViscoelasticLink, OfAShortTimeIsADamper) {
  const auto link =
      effectOf("{name: viscoelastic_link, stiffness_N_per_m: 1000, relaxation_s: 0.02" + std::string(kPoints));
  rise(*link, 0.05, 0.4);
  EXPECT_NEAR(pushed(*link, leaning())[1], -0.8 * 1000.0 * 0.02 * 0.04, 1e-6);
}

TEST(LineFriction, IsDryAlongTheLineAndSmoothBelowItsSpeed) {
  const auto rope =
      effectOf("{name: line_friction, friction_N: 20, proportional_below_m_per_s: 0.004" + std::string(kPoints));
  const mechanism::Vector4 along(-0.6, 0.8, 0.0, 0.0);
  EffectStep now = leaning();
  EXPECT_TRUE(pushed(*rope, now).isZero(0.0)) << "at rest";
  now.pose_velocity[1] = 0.5;
  EXPECT_TRUE(pushed(*rope, now).isApprox(-20.0 * along, 1e-9));
  now.pose_velocity[1] = -0.005;  // the line's rate is 0.8 of it: 4 mm/s
  EXPECT_TRUE(pushed(*rope, now).isApprox(20.0 * std::tanh(1.0) * along, 1e-9));
}

TEST(ElastoplasticLink, BuildsUpOverItsWayStaysAndTurnsItsSign) {
  const auto link = effectOf("{name: elastoplastic_link, yield_N: 50, yield_m: 0.004" + std::string(kPoints));
  const auto resists = [&] { return -pushed(*link, leaning())[1] / 0.8; };
  EXPECT_EQ(resists(), 0.0);
  rise(*link, 0.05, 0.1);  // 4 mm of the line
  EXPECT_NEAR(resists(), 50.0 * (1.0 - std::exp(-1.0)), 1e-9);
  rise(*link, 0.0, 1.0);
  EXPECT_NEAR(resists(), 50.0 * (1.0 - std::exp(-1.0)), 1e-9) << "it keeps at rest";
  rise(*link, 0.05, 2.0);
  EXPECT_NEAR(resists(), 50.0, 1e-6);
  rise(*link, -0.05, 0.2);  // 8 mm back
  EXPECT_NEAR(resists(), 50.0 * (2.0 * std::exp(-2.0) - 1.0), 1e-6);
}

TEST(ElastoplasticLink, IsTheSameHoweverLongTheStepsAre) {
  const auto fine = effectOf("{name: elastoplastic_link, yield_N: 50, yield_m: 0.004" + std::string(kPoints));
  const auto coarse = fine->clone();
  rise(*fine, 0.05, 0.1);
  EffectStep once = leaning();
  once.dt_s = 0.1;
  once.pose_velocity[1] = 0.05;
  coarse->follow(once);
  EXPECT_TRUE(pushed(*coarse, leaning()).isApprox(pushed(*fine, leaning()), 1e-9));
}

TEST(PassiveJointEffect, DampsAndYieldsAgainstItsCoordinateAlone) {
  const std::string joint =
      "{name: passive_joint, coordinate: psi, width_rad: 0.1, towards_positive_Nm: 0, towards_negative_Nm: 0";
  const auto tissue = effectOf(joint + ", damping_Nm_s_per_rad: 3, yield_Nm: 2, yield_rad: 0.05}");
  EffectStep now = leaning();
  now.pose_velocity = mechanism::Vector4(0.1, 0.1, 0.4, -0.2);
  EXPECT_TRUE(pushed(*tissue, now).isApprox(mechanism::Vector4(0.0, 0.0, 0.0, 3.0 * 0.2)));
  for (int n = 0; n < 1000; ++n)
    tissue->follow(now);  // by 0.05 rad towards the negative
  const double yielded = 2.0 * (1.0 - std::exp(-1.0));
  EXPECT_TRUE(pushed(*tissue, now).isApprox(mechanism::Vector4(0.0, 0.0, 0.0, 3.0 * 0.2 + yielded), 1e-9));
  const auto without = effectOf(joint + "}");
  without->follow(now);
  EXPECT_TRUE(pushed(*without, now).isZero(0.0)) << "neither, if the entry says nothing of it";
}

TEST(SupplySagEffect, CountsEveryDriveByItsWeight) {
  const auto given = [](const std::string& weights) {
    const auto sag = effectOf("{name: supply_sag, share: 0.3, half_at_N2: 20000" + weights + "}");
    mechanism::Vector4 force_N = mechanism::Vector4(100.0, -100.0, 100.0, -100.0);
    sag->changeForce(0.001, force_N);
    return force_N;
  };
  const mechanism::Vector4 asked_N(100.0, -100.0, 100.0, -100.0);
  EXPECT_TRUE(given("").isApprox((1.0 - 0.3 * 2.0 / 3.0) * asked_N, 1e-12));
  EXPECT_TRUE(given(", weights: [1, 1, 1, 1]").isApprox(given(""), 1e-12));
  EXPECT_TRUE(given(", weights: [1, 0.5, 0, 0]").isApprox((1.0 - 0.3 * 0.375 * 2.0 / 3.0) * asked_N, 1e-12));
}

TEST(SupplySagEffect, CountsTheWorkOfDrivesAndSparesWhatTheyFeedBack) {
  const auto given = [](double rate_m_per_s) {
    const auto sag = effectOf("{name: supply_sag, share: 0.3, half_at_N2: 20000, work_N2_per_W: 1000}");
    EffectStep now;
    now.rates.setConstant(rate_m_per_s);
    sag->follow(now);
    mechanism::Vector4 force_N = mechanism::Vector4::Constant(100.0);
    sag->changeForce(0.001, force_N);
    return force_N[0];
  };
  EXPECT_NEAR(given(0.0), 100.0 * (1.0 - 0.3 * 4e4 / 6e4), 1e-9);
  EXPECT_NEAR(given(0.05), 100.0 * (1.0 - 0.3 * 6e4 / 8e4), 1e-9);
  EXPECT_NEAR(given(-0.2), 100.0, 1e-9) << "they feed back more than they take";
}

}  // namespace
}  // namespace knee_robot::simulation
