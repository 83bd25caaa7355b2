// Effects on drives, encoders, masses and the platform; how all of them are configured.
#include <cmath>
#include <cstdio>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/effect_law.h"
#include "knee_robot/mechanism/leg_distance.h"
#include "test/refusal.h"
#include "test/simulation/effect_bench.h"

namespace knee_robot::simulation {
namespace {

/// Half of what is the same in both directions: friction cancels.
double bothWays(EffectBench& bench, int axis) {
  const double up = bench.frictionAt(axis, 0.03);
  return 0.5 * (up + bench.frictionAt(axis, -0.03));
}

TEST(DriveEffects, GainAndOffsetShowInBothDirections) {
  for (const double velocity : {0.03, -0.03}) {
    EffectBench gain("{name: force_gain, actuators: [4], factor: 0.9}");
    const double friction = gain.frictionAt(3, velocity), load = gain.load();
    EXPECT_NEAR(friction, (load + std::copysign(19.5, velocity)) / 0.9 - load, 0.6) << velocity;
  }
  EffectBench offset("{name: force_offset, actuators: [2], force_N: 4}");
  EXPECT_NEAR(bothWays(offset, kAxis), -4.0, 0.6);
}

constexpr double kDacStep_N = 0.2;

TEST(DriveEffects, ADeadZoneTakesAsMuchFromEveryCommandAndAllOfSmallOnes) {
  EffectBench bench("{name: drive_dead_zone, actuators: [2], lost_N: 6}");
  bench.push(mechanism::Vector4(100.0, 100.0, 4.0, -50.0), 0.01);
  EXPECT_NEAR(bench.simulation().loads().motor_force[1], 94.0, kDacStep_N);
  EXPECT_NEAR(bench.simulation().loads().motor_force[0], 100.0, kDacStep_N);
  bench.push(mechanism::Vector4(0.0, 4.0, 0.0, 0.0), 0.01);
  EXPECT_EQ(bench.simulation().loads().motor_force[1], 0.0);
  bench.push(mechanism::Vector4(0.0, -40.0, 0.0, 0.0), 0.01);
  EXPECT_NEAR(bench.simulation().loads().motor_force[1], -34.0, kDacStep_N);
}

TEST(DriveEffects, ASaturatingMotorLosesAShareThatGrowsWithTheCommandAndNeverGivesLessForMore) {
  EffectBench bench("{name: motor_saturation, actuators: [2], lost_at_100_N: 0.4}");
  bench.push(mechanism::Vector4(100.0, 100.0, 4.0, -50.0), 0.01);
  EXPECT_NEAR(bench.simulation().loads().motor_force[1], 60.0, kDacStep_N);
  EXPECT_NEAR(bench.simulation().loads().motor_force[0], 100.0, kDacStep_N);
  bench.push(mechanism::Vector4(0.0, -50.0, 0.0, 0.0), 0.01);
  EXPECT_NEAR(bench.simulation().loads().motor_force[1], -40.0, kDacStep_N);
  bench.push(mechanism::Vector4(0.0, 200.0, 0.0, 0.0), 0.01);
  EXPECT_NEAR(bench.simulation().loads().motor_force[1], 62.5, kDacStep_N) << "the most that it gives, at 125 N";
}

TEST(DriveEffects, ADriveCutsItsCurrentOnceTheAxisHasStoodForAWhile) {
  EffectBench bench("{name: idle_current_reduction, actuators: [2], cut: 0.2, after_s: 0.3, time_constant_s: 0.05}");
  const mechanism::Vector4 held = bench.weight();  // friction holds what leg 2 loses
  ASSERT_GT(std::abs(held[1]), 5.0);
  bench.push(held, 0.25);
  EXPECT_NEAR(bench.simulation().loads().motor_force[1], held[1], kDacStep_N);
  bench.push(held, 0.5);
  EXPECT_NEAR(bench.simulation().loads().motor_force[1], 0.8 * held[1], kDacStep_N);
  EXPECT_NEAR(bench.simulation().loads().motor_force[3], held[3], 2.0 * kDacStep_N);
}

TEST(DriveEffects, DelayAndLagFollowTheCommandLater) {
  const auto stepResponse = [](const std::string& effect) {
    EffectBench bench(effect);
    bench.push(mechanism::Vector4::Zero(), 0.1);
    std::vector<double> response;
    for (int i = 0; i < 12; ++i) {
      bench.push(mechanism::Vector4::Constant(100.0), EffectBench::kStep);
      response.push_back(bench.simulation().loads().motor_force[kAxis]);
    }
    return response;
  };
  const std::vector<double> plain = stepResponse("");
  EXPECT_NEAR(plain[0], 100.0, 0.3);
  const std::vector<double> late = stepResponse("{name: delay, time_s: 0.0035}");
  EXPECT_EQ(late[2], 0.0);
  EXPECT_NEAR(late[3], 0.5 * plain[0], 1e-9);
  EXPECT_NEAR(late[4], plain[0], 1e-9);
  const std::vector<double> lag = stepResponse("{name: drive_lag, time_constant_s: 0.004}");
  EXPECT_NEAR(lag[3], (1.0 - std::exp(-1.0)) * plain[0], 1e-9);
}

TEST(DriveEffects, ExertNothingWhenTheDrivesAreOff) {
  const mechanism::Robot robot = configuredRobot("final");
  RobotImage image;
  RobotSimulation simulation(
      robot, dynamics::loadRobotInertia(robot),
      parseSimulationParameters(
          "axes: [{viscous_N_s_per_m: 150, coulomb_N: 15}]\neffects: [{name: force_offset, force_N: 4}]", "off.yaml"),
      image);
  ASSERT_TRUE(simulation.step(1e-3));
  EXPECT_EQ(simulation.loads().motor_force, mechanism::Vector4(mechanism::Vector4::Zero()));
}

TEST(EncoderEffects, AFlexibleCouplingWindsUpByForceOverStiffness) {
  EffectBench bench("{name: flexible_coupling, actuators: [4], stiffness_N_per_m: 2e5, damping_N_s_per_m: 300}");
  double wound = 0.0, force = 0.0;
  bench.follow(
      1.0, [](double) { return mechanism::Vector4(mechanism::Vector4::Zero()); },
      [&](const EffectSample& s) {
        if (s.time_s < 0.9) return;
        wound += 0.01 * (s.seen - s.truth)[3];
        force += 0.01 * s.force[3];
      });
  std::printf("%.1f N wind the coupling up by %.1f um\n", force, 1e6 * wound);
  EXPECT_GT(force, 20.0);
  EXPECT_NEAR(wound, force / 2e5, 3e-6);
}

TEST(EncoderEffects, BacklashIsCrossedAtReversals) {
  EffectBench bench("{name: backlash, actuators: [2], width_m: 0.0004}", 80.0);  // friction beyond the leg's weight
  double ahead[2] = {0.0, 0.0};
  int count[2] = {0, 0};
  bench.follow(
      4.0, [](double t) { return mechanism::Vector4(0.0, wave(t, 0.01, 0.5)[1], 0.0, 0.0); },
      [&](const EffectSample& s) {
        if (s.time_s < 0.3 || std::abs(s.rates[kAxis]) < 0.02) return;
        const int way = s.rates[kAxis] > 0.0 ? 1 : 0;
        ahead[way] += (s.seen - s.truth)[kAxis];
        ++count[way];
      });
  const double play = ahead[1] / count[1] - ahead[0] / count[0];
  std::printf("the encoder runs ahead by %.0f um more while lengthening\n", 1e6 * play);
  // The play, and the contact's compression by friction on either side.
  EXPECT_NEAR(play, 0.0004 + 2.0 * (80.0 + 150.0 * 0.025) / 2e6, 3e-5);
}

TEST(MassEffects, ChangeThePlantAsPhysicsSays) {
  const mechanism::Pose pose(0.02, 0.66, 0.05, -0.1);
  mechanism::Motion rest;
  rest.pose = pose;
  const auto weightOf = [&](const EffectBench& bench) {
    const dynamics::RigidModel& rigid = bench.simulation().model().rigid;
    mechanism::RobotMotion all;
    mechanism::robotMotion(rigid.mechanism, rest, all);
    return dynamics::poseForces(rigid, all);
  };
  const EffectBench plain("");
  const mechanism::Vector4 before = weightOf(plain);
  const EffectBench payload("{name: payload, mass_kg: 5, center_m: [0, 0, 0.1]}");
  EXPECT_NEAR(weightOf(payload)[1] - before[1], 5.0 * 9.81, 1e-9);
  const double arm =
      (platformPoint(pose, mechanism::Vector3(0, 0, 0.1)) - platformPoint(pose, mechanism::Vector3::Zero())).x();
  EXPECT_NEAR(weightOf(payload)[2] - before[2], -5.0 * 9.81 * arm, 1e-9);
  const EffectBench tilted("{name: base_tilt, about_x_deg: 0, about_y_deg: 2}");
  const mechanism::Vector3 gravity = tilted.simulation().model().rigid.gravity;
  EXPECT_NEAR(gravity.norm(), 9.81, 1e-12);
  EXPECT_NEAR(gravity.x(), 9.81 * std::sin(2.0 * M_PI / 180.0), 1e-12);  // the base's X now points downhill
  const EffectBench heavy("{name: reflected_inertia, actuators: [2], mass_kg: 6}");
  EXPECT_EQ(heavy.simulation().model().rigid.rotor_mass,
            mechanism::Vector4(plain.simulation().model().rigid.rotor_mass + 6.0 * mechanism::Vector4::Unit(kAxis)));
}

TEST(PlatformEffects, ASpringPullsDownItsPotential) {
  EffectBench bench(
      "{name: spring, stiffness_N_per_m: 400, anchor_m: [0.2, 0.3, 0], point_m: [0.2, 0.2, 0], free_length_m: 0.5}");
  const mechanism::Pose pose = bench.simulation().state().pose;
  bench.push(bench.weight(), EffectBench::kStep);
  const auto potential = [](const mechanism::Pose& at) {
    const double stretch =
        (platformPoint(at, mechanism::Vector3(0.2, 0.2, 0)) - mechanism::Vector3(0.2, 0.3, 0)).norm() - 0.5;
    return 0.5 * 400.0 * stretch * stretch;
  };
  for (int i = 0; i < 4; ++i) {
    const mechanism::Vector4 step = 1e-6 * mechanism::Vector4::Unit(i);
    const double slope = (potential(pose + step) - potential(pose - step)) / 2e-6;
    EXPECT_NEAR(bench.simulation().loads().pose_force[i], -slope, 1e-5) << i;
  }
}

TEST(PlatformEffects, AJointResistsByAFactorOfEEachWidthTowardsBothEnds) {
  const auto moment = [](const std::string& coordinate, Eigen::Index which, double positive, double negative) {
    EffectBench bench("{name: passive_joint, coordinate: " + coordinate + ", width_rad: 0.1, towards_positive_Nm: " +
                      std::to_string(positive) + ", towards_negative_Nm: " + std::to_string(negative) + "}");
    const double turned = bench.simulation().state().pose[which] / 0.1;
    bench.push(bench.weight(), EffectBench::kStep);
    const mechanism::Vector4 force = bench.simulation().loads().pose_force;
    EXPECT_EQ(force.cwiseAbs().sum(), std::abs(force[which])) << "nothing else is pushed";
    return std::pair{force[which], turned};
  };
  const auto [stretched, at] = moment("theta", 2, 3.0, 0.0);
  EXPECT_NEAR(stretched, -3.0 * std::exp(at), 1e-12);
  const auto [bent, there] = moment("psi", 3, 0.0, 5.0);
  EXPECT_NEAR(bent, 5.0 * std::exp(-there), 1e-12);
}

TEST(PlatformEffects, AStrapActsBeyondItsLengthOnlyAndAStopBelowIt) {
  const auto strap = [](const std::string& side, double acts_from_m) {
    EffectBench bench(
        "{name: one_sided_spring, force_at_0.1_m_N: 60, exponent: 1.5, anchor_m: [0.2, 0.3, 1.5], point_m: "
        "[0.2, 0.2, 0], acts_from_m: " +
        std::to_string(acts_from_m) + ", side: " + side + "}");
    bench.push(bench.weight(), EffectBench::kStep);
    return bench.simulation().loads().pose_force;
  };
  const mechanism::Pose pose = EffectBench("").simulation().state().pose;
  const mechanism::Vector3 span =
      mechanism::Vector3(0.2, 0.3, 1.5) - platformPoint(pose, mechanism::Vector3(0.2, 0.2, 0));
  const double length = span.norm();
  EXPECT_TRUE(strap("longer", length + 0.001).isZero());
  EXPECT_TRUE(strap("shorter", length - 0.001).isZero());
  const double force_N = 60.0 * std::pow(0.04 / 0.1, 1.5);
  const mechanism::Vector4 pulled = poseForceOf(pose, mechanism::Vector3(0.2, 0.2, 0), force_N * span.normalized());
  EXPECT_TRUE(strap("longer", length - 0.04).isApprox(pulled, 1e-4));
  EXPECT_TRUE(strap("shorter", length + 0.04).isApprox(-pulled, 1e-4));
}

TEST(PlatformEffects, AHoseBetweenTwoLegsPullsBeyondItsLengthAndABumperPushesBelowIt) {
  const mechanism::Robot robot = configuredRobot("final");
  const mechanism::Pose pose = EffectBench("").simulation().state().pose;
  for (const auto& [name, between] : {std::pair{"lengths", mechanism::BetweenLegs::Lengths},
                                      {"cylinders", mechanism::BetweenLegs::Cylinders},
                                      {"rods", mechanism::BetweenLegs::Rods}}) {
    const mechanism::LegDistance there = mechanism::legDistance(*robot.mechanism, pose, {1, 2, between, 0.2});
    const auto pushed = [&, between_legs = std::string(name)](const std::string& side, double acts_from_m) {
      EffectBench bench("{name: link_between_legs, first_leg: 2, second_leg: 3, between: " + between_legs +
                        ", acts_from_m: " + std::to_string(acts_from_m) + ", side: " + side +
                        ", stiffness_N_per_m: 300, stiffening_N_per_m2: 2000}");
      bench.push(bench.weight(), EffectBench::kStep);
      return bench.simulation().loads().pose_force;
    };
    const mechanism::Vector4 pull = -(300.0 + 2000.0 * 0.04) * 0.04 * there.by_pose;
    EXPECT_TRUE(pushed("longer", there.length_m + 0.001).isZero()) << name;
    EXPECT_TRUE(pushed("shorter", there.length_m - 0.001).isZero()) << name;
    EXPECT_TRUE(pushed("longer", there.length_m - 0.04).isApprox(pull, 1e-3)) << name;
    EXPECT_TRUE(pushed("shorter", there.length_m + 0.04).isApprox(-pull, 1e-3)) << name;
  }
}

class JointFrictionEffects : public testing::TestWithParam<const char*> {};

TEST_P(JointFrictionEffects, AreTheLawsThatTraceAdds) {
  EffectBench bench(std::string("{name: ") + GetParam() + ", coulomb_N_m: 0, viscous_N_m_s_per_rad: 2}");
  const auto law = dynamics::effectLaw(GetParam(), "", {1e-4});
  const mechanism::Robot robot = configuredRobot("final");
  double largest = 0.0;
  mechanism::Vector4 before = mechanism::Vector4::Zero();
  bench.follow(
      3.0,
      [](double t) {
        return mechanism::Vector4(0.03 * std::sin(3.0 * t), -0.03 * std::sin(3.0 * t), 0.03 * std::sin(2.0 * t), 0.0);
      },
      [&](const EffectSample& s) {
        if (s.time_s < 0.05) return;  // the first push accelerates within a substep
        mechanism::Motion motion;
        motion.pose = bench.simulation().state().pose;
        motion.pose_velocity = bench.simulation().state().pose_velocity;
        dynamics::PoseColumns columns;
        dynamics::EffectInstant at;
        dynamics::EffectState state;
        at.mechanism = &*robot.mechanism;
        at.motion = &motion;
        law->poseColumns(at, state, columns);
        mechanism::Vector4 expected = mechanism::Vector4::Zero();
        for (int c = 1; c < law->coefficients(); c += 2)
          expected -= 2.0 * columns.col(c);
        // The load is that of the last substep, the state that after it.
        const double within_substep = 0.1 * (expected - before).norm();
        EXPECT_LT((bench.simulation().loads().pose_force - expected).norm(),
                  0.02 * expected.norm() + 0.01 + within_substep);
        before = expected;
        largest = std::max(largest, expected.norm());
      });
  EXPECT_GT(largest, 0.5);
}
INSTANTIATE_TEST_SUITE_P(OfBothEndsOfTheLegs, JointFrictionEffects,
                         testing::Values("platform_joint_friction", "base_joint_friction"));

TEST(PlatformEffects, APushLastsAsLongAsItSays) {
  EffectBench bench(
      "{name: external_force, start_s: 0.3, end_s: 0.5, rise_s: 0.05, force_N: [0, 0, -40], point_m: [0.1, 0, 0]}");
  double before = 0.0, during = 0.0, after = 0.0;
  for (int i = 0; i < 700; ++i) {
    bench.push(bench.weight(), EffectBench::kStep);
    const double push = bench.simulation().loads().pose_force[1];
    const double time = bench.simulation().time();
    if (time < 0.3) before = std::max(before, std::abs(push));
    if (time > 0.36 && time < 0.44) during = push;
    if (time > 0.502) after = std::max(after, std::abs(push));
  }
  EXPECT_EQ(before, 0.0);
  EXPECT_NEAR(during, -40.0, 1e-9);
  EXPECT_EQ(after, 0.0);
}

TEST(Effects, OfNoStrengthChangeNoBit) {
  const std::string nothing =
      "{name: asymmetric_coulomb, difference_N: 0}, {name: asymmetric_viscous, difference_N_s_per_m: 0},"
      "{name: stribeck, excess_N: 0, velocity_m_per_s: 0.01}, {name: load_dependent_friction, share: 0},"
      "{name: screw_ripple, amplitude_N: 0, period_m: 0.01}, {name: load_ripple, share: 0, period_m: 0.01},"
      "{name: platform_joint_friction, coulomb_N_m: 0}, {name: base_joint_friction, coulomb_N_m: 0},"
      "{name: quadratic_drag, drag_N_s2_per_m2: 0},"
      "{name: position_dependent_friction, amplitude_N: 0, center_m: 0.7, width_m: 0.01},"
      "{name: thermal_drift, time_constant_s: 5}, {name: payload, mass_kg: 0, center_m: [0, 0, 0]}, {name: "
      "base_tilt},"
      "{name: spring, stiffness_N_per_m: 0, anchor_m: [0, 0, 0], point_m: [0, 0, 0]}, {name: force_gain, factor: 1},"
      "{name: force_offset, force_N: 0}, {name: delay, time_s: 0}, {name: reflected_inertia, mass_kg: 0}";
  EffectBench with(nothing), without("");
  const auto motion = [](double t) { return wave(t, 0.02, 0.7); };
  std::vector<EffectSample> expected;
  without.follow(2.0, motion, [&](const EffectSample& s) { expected.push_back(s); });
  std::size_t k = 0;
  with.follow(2.0, motion, [&](const EffectSample& s) {
    ASSERT_EQ(s.truth, expected[k].truth) << k;
    ASSERT_EQ(s.force, expected[k].force) << k;
    ++k;
  });
  EXPECT_EQ(k, 2000u);
  EXPECT_EQ(with.simulation().state().pose, without.simulation().state().pose);
}

std::string refusalOfEffect(const std::string& effect) {
  return refusalOf([&] {
    parseSimulationParameters("axes: [{viscous_N_s_per_m: 3, coulomb_N: 4}]\neffects:\n  - " + effect + "\n",
                              "test.yaml");
  });
}

TEST(Effects, AreReadStrictly) {
  EXPECT_EQ(refusalOfEffect("{name: force_offset, force_N: 4}"), "");
  for (const char* wrong :
       {"{name: gremlin, force_N: 4}", "{name: force_offset}", "{name: force_offset, force_N: 4, force: 3}",
        "{name: force_offset, force_N: .nan}", "{name: force_offset, force_N: 4, actuators: [5]}",
        "{name: force_offset, force_N: 4, actuators: [1.5]}", "{name: force_offset, force_N: 4, actuators: []}",
        "{name: stribeck, excess_N: -1, velocity_m_per_s: 0.01}",
        "{name: external_force, start_s: 3, end_s: 2, force_N: [0, 0, 1], point_m: [0, 0, 0]}"}) {
    const std::string sentence = refusalOfEffect(wrong);
    EXPECT_EQ(sentence.rfind("test.yaml:3", 0), 0u) << wrong << " -> " << sentence;
  }
  EXPECT_NE(refusalOfEffect("{name: gremlin}").find("stribeck"), std::string::npos);  // says what there is
}

TEST(Effects, ThatNeedARotorRefuseAnAxisWithoutOne) {
  EXPECT_THROW(EffectBench("{name: backlash, width_m: 0.001}, {name: flexible_coupling, stiffness_N_per_m: 1e5}"),
               InputError);
}

}  // namespace
}  // namespace knee_robot::simulation
