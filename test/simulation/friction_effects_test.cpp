// Effects that change friction: each is seen in the friction that is measured through the robot's cards.
#include <cmath>
#include <cstdio>

#include "test/simulation/effect_bench.h"

namespace knee_robot::simulation {
namespace {

constexpr double kNear_N = 0.6;  ///< two DAC steps

double plain(double velocity) {
  return 150.0 * velocity + std::copysign(15.0, velocity);
}

TEST(FrictionEffects, AreAbsentFromAPlainRobot) {
  EffectBench bench("");
  for (const double v : {0.005, 0.05, -0.05})
    EXPECT_NEAR(bench.frictionAt(kAxis, v), plain(v), kNear_N) << v;
}

TEST(FrictionEffects, StribeckHasItsMinimum) {
  EffectBench bench("{name: stribeck, actuators: [2], excess_N: 10, velocity_m_per_s: 0.006}");
  double friction[4];
  const double velocities[] = {0.003, 0.006, 0.02, 0.1};
  for (int k = 0; k < 4; ++k) {
    const double v = velocities[k];
    friction[k] = bench.frictionAt(kAxis, k % 2 ? -v : v) * (k % 2 ? -1.0 : 1.0);
    EXPECT_NEAR(friction[k], plain(v) + 10.0 * std::exp(-std::pow(v / 0.006, 2.0)), kNear_N) << v;
  }
  std::printf("friction at 3, 6, 20, 100 mm/s: %.2f %.2f %.2f %.2f N\n", friction[0], friction[1], friction[2],
              friction[3]);
  EXPECT_GT(friction[0], friction[2] + 3.0);
  EXPECT_GT(friction[3], friction[2] + 3.0);
}

TEST(FrictionEffects, AgeingWearsOffTheFasterTheMoreTheAxisMoves) {
  EffectBench bench("{name: frictional_ageing, actuators: [2], excess_N: 20, time_constant_s: 0.2, way_m: 0.0006}");
  for (const double v : {0.002, -0.01, 0.1}) {
    const double aged = 5.0 / (5.0 + std::abs(v) / 0.0006);  // where growth and wear are in balance
    EXPECT_NEAR(bench.frictionAt(kAxis, v), plain(v) + std::copysign(20.0 * aged, v), kNear_N) << v;
  }
}

TEST(FrictionEffects, AfterAReversalItIsLargerAndFallsOffOverAWay) {
  EffectBench bench("{name: reversal_friction, actuators: [2], excess_N: 20, way_m: 0.004, rise_m: 0.0005}");
  constexpr double kSpeed_m_per_s = 0.03, kTurns_s = 0.5;
  const double ways_m[] = {0.002, 0.004, 0.012};
  double friction[3] = {}, turned = 0.0;
  int count[3] = {};
  bench.follow(
      1.0,
      [&](double t) {
        return mechanism::Vector4(0.0, kSpeed_m_per_s * (kTurns_s - std::abs(kTurns_s - std::max(0.0, t))), 0.0, 0.0);
      },
      [&](const EffectSample& s) {
        turned = std::max(turned, s.truth[kAxis]);
        for (int k = 0; k < 3; ++k) {
          if (s.time_s < kTurns_s || std::abs(turned - s.truth[kAxis] - ways_m[k]) > 2e-4) continue;
          friction[k] -= s.friction[kAxis];
          ++count[k];
        }
      });
  for (int k = 0; k < 3; ++k) {
    ASSERT_GT(count[k], 5);
    const double excess = 20.0 * (1.0 - std::exp(-ways_m[k] / 0.0005)) * std::exp(-ways_m[k] / 0.004);
    EXPECT_NEAR(friction[k] / count[k], plain(kSpeed_m_per_s) + excess, 2.0 * kNear_N) << ways_m[k] << " m behind";
  }
}

TEST(FrictionEffects, AsymmetryDiffersBetweenDirections) {
  EffectBench coulomb("{name: asymmetric_coulomb, actuators: [2], difference_N: 8}");
  EXPECT_NEAR(coulomb.frictionAt(kAxis, 0.03), plain(0.03) + 4.0, kNear_N);
  EXPECT_NEAR(coulomb.frictionAt(kAxis, -0.03), plain(-0.03) + 4.0, kNear_N);
  EffectBench viscous("{name: asymmetric_viscous, actuators: [2], difference_N_s_per_m: 200}");
  EXPECT_NEAR(viscous.frictionAt(kAxis, 0.05), plain(0.05) + 100.0 * 0.05, kNear_N);
  EXPECT_NEAR(viscous.frictionAt(kAxis, -0.05), plain(-0.05) + 100.0 * 0.05, kNear_N);
}

TEST(FrictionEffects, QuadraticDragGrowsWithTheSquare) {
  EffectBench bench("{name: quadratic_drag, actuators: [2], drag_N_s2_per_m2: 3000}");
  for (const double v : {0.02, -0.05, 0.1})
    EXPECT_NEAR(bench.frictionAt(kAxis, v), plain(v) + 3000.0 * v * std::abs(v), kNear_N) << v;
}

TEST(FrictionEffects, LoadDependenceFollowsTheLoad) {
  EffectBench bench("{name: load_dependent_friction, actuators: [4], share: 0.2}");
  double load = 0.0;
  int count = 0;
  double friction = 0.0;
  bench.follow(
      1.0, [](double t) { return mechanism::Vector4(0.0, 0.0, 0.0, 0.02 * std::max(0.0, t)); },
      [&](const EffectSample& s) {
        if (s.time_s < 0.5) return;
        load += s.force[3] - s.friction[3];  // what frictionless rigid links take
        friction += s.friction[3];
        ++count;
      });
  load /= count;
  friction /= count;
  std::printf("load %.1f N, friction %.2f N\n", load, friction);
  EXPECT_GT(load, 20.0);
  EXPECT_NEAR(friction, plain(0.02) + 0.2 * load, kNear_N);
}

TEST(FrictionEffects, ATightPlaceIsFeltThereOnly) {
  EffectBench bench(
      "{name: position_dependent_friction, actuators: [2], amplitude_N: 12, center_m: 0.71, width_m: 0.004}");
  double at_place = 0.0, away = 0.0;
  int n_place = 0, n_away = 0;
  bench.follow(
      1.0, [](double t) { return mechanism::Vector4(0.0, 0.03 * std::max(0.0, t), 0.0, 0.0); },
      [&](const EffectSample& s) {
        const double distance = std::abs(s.truth[kAxis] - 0.71);
        if (s.time_s < 0.15) return;
        if (distance < 0.0005) at_place += s.friction[kAxis], ++n_place;
        if (distance > 0.010) away += s.friction[kAxis], ++n_away;
      });
  ASSERT_GT(n_place, 20);
  ASSERT_GT(n_away, 50);
  EXPECT_NEAR(at_place / n_place, plain(0.03) + 12.0, 2.0 * kNear_N);
  EXPECT_NEAR(away / n_away, plain(0.03), 2.0 * kNear_N);
}

TEST(FrictionEffects, AScrewWhirlsAtASpeedThatFallsWithTheSquareOfItsLength) {
  const double length_m = 0.715, critical_m_per_s = 0.04;
  for (const auto& [speed, share] : {std::pair{critical_m_per_s, 1.0}, std::pair{0.01, 0.0}}) {
    EffectBench bench(
        "{name: screw_whirl, actuators: [2], peak_N: 12, critical_m_per_s: 0.04, at_length_m: 0.715, width_m_per_s: "
        "0.01}");
    double near = 0.0;
    int count = 0;
    const double velocity = speed;
    bench.follow(
        1.0, [&](double t) { return mechanism::Vector4(0.0, velocity * std::max(0.0, t), 0.0, 0.0); },
        [&](const EffectSample& s) {
          if (s.time_s < 0.3 || std::abs(s.truth[kAxis] - length_m) > 0.007) return;
          near += s.friction[kAxis];
          ++count;
        });
    ASSERT_GT(count, 10) << "it passes " << length_m << " m";
    EXPECT_NEAR(near / count, plain(speed) + 12.0 * share, 2.0 * kNear_N) << speed << " m/s";
  }
}

/// What repeats with every 5 mm of the screw, along sine and cosine. The drive has to overcome it: the commanded force
/// carries its negative.
Eigen::Vector2d rippleOf(EffectBench& bench) {
  Eigen::Vector2d along = Eigen::Vector2d::Zero();
  int count = 0;
  bench.follow(
      1.0, [](double t) { return mechanism::Vector4(0.0, 0.02 * std::max(0.0, t), 0.0, 0.0); },
      [&](const EffectSample& s) {
        if (s.time_s < 0.25) return;  // three periods
        const double angle = 2.0 * M_PI * s.truth[kAxis] / 0.005;
        along += (s.friction[kAxis] - plain(0.02)) * Eigen::Vector2d(std::sin(angle), std::cos(angle));
        ++count;
      });
  return -2.0 / count * along;
}
const Eigen::Vector2d kPhase(std::cos(40.0 * M_PI / 180.0), std::sin(40.0 * M_PI / 180.0));

TEST(FrictionEffects, RippleRepeatsWithTheScrew) {
  EffectBench bench("{name: screw_ripple, actuators: [2], amplitude_N: 5, period_m: 0.005, phase_deg: 40}");
  EXPECT_LT((rippleOf(bench) - 5.0 * kPhase).cwiseAbs().maxCoeff(), kNear_N);
}

TEST(FrictionEffects, LoadRippleGrowsWithWhatTheLegPassesOn) {
  EffectBench bench("{name: load_ripple, actuators: [2], share: 0.05, period_m: 0.005, phase_deg: 40}");
  const double load = bench.weight()[kAxis];
  EXPECT_LT((rippleOf(bench) - 0.05 * load * kPhase).cwiseAbs().maxCoeff(), kNear_N);
}

TEST(FrictionEffects, WarmingUpChangesFriction) {
  EffectBench bench(
      "{name: thermal_drift, actuators: [2], coulomb_change: -0.4, viscous_change: -0.4, time_constant_s: 1}");
  double warm[2];
  for (int k = 0; k < 2; ++k) {
    bench.frictionAt(kAxis, k % 2 ? -0.03 : 0.03);
    const double level = bench.frictionAt(kAxis, k % 2 ? -0.03 : 0.03) / plain(k % 2 ? -0.03 : 0.03);
    warm[k] = level;
    if (k == 0) bench.frictionAt(kAxis, -0.005);  // three more seconds
  }
  std::printf("friction relative to the cold robot: %.3f, later %.3f\n", warm[0], warm[1]);
  EXPECT_LT(warm[0], 0.95);
  EXPECT_NEAR(warm[1], 0.6, 0.03);
  EXPECT_GT(warm[0], warm[1] + 0.05);
}

/// Friction of a drive that warms up with a time constant of a second, over the cold one's: after four seconds of
/// motion, and after five of rest as soon as it moves again.
std::pair<double, double> warmAndRested(const std::string& heated_by, double velocity) {
  EffectBench bench(
      "{name: thermal_drift, actuators: [2], coulomb_change: -0.4, viscous_change: -0.4, time_constant_s: "
      "1" +
      heated_by + "}");
  double warm = 0.0, rested = 0.0;
  int n_warm = 0, n_rested = 0;
  bench.follow(
      9.2,
      [&](double t) {
        const double way = velocity * (std::clamp(t, 0.0, 4.0) + std::max(0.0, t - 8.8));
        return mechanism::Vector4(0.0, way, 0.0, 0.0);
      },
      [&](const EffectSample& s) {
        if (s.time_s > 3.5 && s.time_s < 3.9) warm += s.friction[kAxis], ++n_warm;
        if (s.time_s > 9.0) rested += s.friction[kAxis], ++n_rested;
      });
  return {warm / n_warm / plain(velocity), rested / n_rested / plain(velocity)};
}

TEST(FrictionEffects, ByTheClockADriveWarmsUpAtRestToo) {
  const auto [warm, rested] = warmAndRested("", 0.02);
  EXPECT_NEAR(warm, 0.6, 0.05);
  EXPECT_NEAR(rested, 0.6, 0.05);
}

TEST(FrictionEffects, ByItsMotionADriveCoolsAtRest) {
  const auto [warm, rested] = warmAndRested(", heated_by: motion", 0.02);
  EXPECT_NEAR(warm, 0.6, 0.05);
  EXPECT_NEAR(rested, 0.88, 0.06) << "0.3 s of motion warm it by a quarter";
}

TEST(FrictionEffects, ByItsWorkADriveWarmsUpTheMoreTheFasterItMoves) {
  const std::string work = ", heated_by: work, full_heat_W: 0.6";
  // 15 N and 150 N s/m, times 1 - 0.4 warmth, times the speed, over the full heat.
  for (const double velocity : {0.01, 0.02}) {
    const double cold_heat = velocity * (15.0 + 150.0 * velocity) / 0.6;
    const double balance = cold_heat / (1.0 + 0.4 * cold_heat);
    EXPECT_NEAR(warmAndRested(work, velocity).first, 1.0 - 0.4 * balance, 0.05) << velocity;
  }
}

TEST(FrictionEffects, PreslidingYieldsElasticallyAndRemembers) {
  EffectBench bench("{name: presliding, actuators: [2], stiffness_N_per_m: 5e5, damping_N_s_per_m: 300}");
  bench.push(bench.weight(), 0.5);
  bench.pushGently();
  const double rest = bench.simulation().lengths()[kAxis];
  bench.push(bench.weight() + 8.0 * mechanism::Vector4::Unit(kAxis), 0.5);
  const double pushed = bench.simulation().lengths()[kAxis] - rest;
  bench.push(bench.weight(), 0.5);
  const double kept = bench.simulation().lengths()[kAxis] - rest;
  std::printf("8 N below 15 N of friction moves the leg by %.1f um, %.1f um stay\n", 1e6 * pushed, 1e6 * kept);
  // Dahl: x = F / stiffness ln(1 / (1 - f / F)) forth, F / stiffness ln(1 + f / F) back.
  EXPECT_NEAR(pushed, -15.0 / 5e5 * std::log(1.0 - 8.0 / 15.0), 4e-6);  // a DAC step is 1 um here
  EXPECT_NEAR(kept, pushed - 15.0 / 5e5 * std::log(1.0 + 8.0 / 15.0), 2e-6);
  EXPECT_NEAR(bench.frictionAt(kAxis, 0.03), plain(0.03), kNear_N);  // sliding it is plain Coulomb friction
}

TEST(FrictionEffects, TrueRestHoldsUpToTheLevelAtRest) {
  const auto movedBy = [](const std::string& effects, int axis, double beyond_N) {
    EffectBench bench(effects);
    const mechanism::Pose start = bench.simulation().state().pose;
    bench.push(bench.weight() + beyond_N * mechanism::Vector4::Unit(axis), 1.0);
    return mechanism::Vector4(bench.simulation().state().pose - start).norm();
  };
  EXPECT_EQ(movedBy("", 1, 14.0), 0.0);
  EXPECT_GT(movedBy("", 1, 16.5), 1e-4);
  const std::string stribeck = "{name: stribeck, excess_N: 10, velocity_m_per_s: 0.006}";
  EXPECT_EQ(movedBy(stribeck, 1, 24.0), 0.0);
  EXPECT_GT(movedBy(stribeck, 1, 26.5), 1e-4);
  const std::string asymmetric = "{name: asymmetric_coulomb, difference_N: 8}";
  EXPECT_EQ(movedBy(asymmetric, 1, 18.0), 0.0);
  EXPECT_EQ(movedBy(asymmetric, 1, -10.0), 0.0);
  EXPECT_GT(movedBy(asymmetric, 1, -12.5), 1e-4);
  const double weight = EffectBench("").weight()[3];
  const std::string loaded = "{name: load_dependent_friction, actuators: [4], share: 0.2}";
  EXPECT_EQ(movedBy(loaded, 3, 15.0 + 0.2 * weight - 1.0), 0.0);
  EXPECT_GT(movedBy(loaded, 3, 15.0 + 0.2 * weight + 2.0), 1e-4);
}

/// Largest |what the simulator says that effects took of axis 2's command - that of a drag| (N) along a wave with reversals and rests.
double worstUnmodelled(const std::string& effects, double drag_N_s2_per_m2) {
  EffectBench bench(effects, 60.0);
  double worst = 0.0, before = 0.0;
  bench.follow(
      8.0,
      [](double t) {
        mechanism::Vector4 legs;
        for (int i = 0; i < mechanism::kLegs; ++i)  // each turns round at times of its own: some stick while some slide
          legs[i] = wave(t, 0.004, 0.15 + 0.1 * i)[i];
        return legs;
      },
      [&](const EffectSample& sample) {
        const double rate = 0.5 * (before + sample.rates[kAxis]), drag = drag_N_s2_per_m2 * rate * std::abs(rate);
        before = sample.rates[kAxis];
        if (sample.time_s < 0.1) return;  // the drives come on
        worst = std::max(worst, std::abs(bench.simulation().unmodelled()[kAxis] - drag));
      });
  return worst;
}

TEST(FrictionEffects, OfAnotherAxisTakeNothingOfItsCommandEvenWhenItSticks) {
  EXPECT_LT(worstUnmodelled("{name: quadratic_drag, actuators: [1], drag_N_s2_per_m2: 3000}", 0.0), 1e-6);
}

TEST(FrictionEffects, HowFrictionComesUpFromRestIsTheRobotsOwnAndNoEffectOnItsCommand) {
  for (const char* law : {"law: tanh, speed_m_per_s: 0.001", "law: rational, speed_m_per_s: 0.002",
                          "law: lugre, distance_m: 2e-4", "law: maxwell_slip, distance_m: 2e-4"}) {
    const std::string near_rest = std::string("{name: near_rest_friction, ") + law + "}";
    EXPECT_LT(worstUnmodelled(near_rest, 0.0), 1e-6) << law;
    EXPECT_LT(worstUnmodelled("{name: quadratic_drag, drag_N_s2_per_m2: 3000}, " + near_rest, 3000.0), 0.02) << law;
  }
}

}  // namespace
}  // namespace knee_robot::simulation
