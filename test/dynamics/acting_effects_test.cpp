// Which effects of a model act instant by instant, what they remember, and that they cost neither memory nor surprises.
#include "knee_robot/dynamics/acting_effects.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/force_parts.h"
#include "knee_robot/dynamics/warming.h"
#include "test/allocation_guard.h"
#include "test/control/some_model.h"
#include "test/mechanism/configured_robot.h"

namespace knee_robot::dynamics {
namespace {

mechanism::Robot robotA() {
  return mechanism::configuredRobot("A");
}

ModelEffect effect(const std::string& name, int actuator, const std::vector<double>& shape,
                   const std::vector<double>& coefficients) {
  ModelEffect e;
  e.name = name;
  if (actuator > 0) {
    e.actuators = {actuator};
  } else {
    e.actuators = {1, 2, 3, 4};
  }
  for (const double value : shape)
    e.shape.push_back({"shape", value});
  for (const double value : coefficients)
    e.coefficients.push_back({"coefficient", value});
  return e;
}

std::vector<ModelEffect> oneOfEach() {
  ModelEffect map = effect("unnamed", 2, {0.6, 0.7, 0.8}, {1.0, -2.0, 3.0});
  map.depends_on = "position_1_m_times_direction";
  ModelEffect wheel = effect("unnamed", 0, {}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2.0, 0, 0, -2.0, 0});
  wheel.depends_on = "platform_velocity";
  return {effect("asymmetric_coulomb", 1, {}, {2.0}),
          effect("asymmetric_viscous", 1, {}, {30.0}),
          effect("stribeck", 2, {0.006}, {6.0}),
          effect("presliding", 3, {1e-3}, {4.0}),
          effect("load_dependent_friction", 4, {}, {0.05}),
          effect("load_dependent_viscous", 4, {}, {0.5}),
          effect("power_flow_friction", 1, {}, {0.03, 0.02, 1e-4, 1e-4}),
          effect("position_dependent_friction", 2, {0.7, 0.05, 0.6, 0.8}, {5.0}),
          effect("screw_ripple", 3, {0.01, 0.0}, {2.0, 1.0}),
          effect("screw_ripple", 4, {0.01, 1.0}, {2.0, 1.0}),
          effect("quadratic_drag", 1, {}, {900.0}),
          effect("screw_whirl", 3, {0.03, 0.01, 0.7}, {5.0}),
          effect("reversal_friction", 1, {0.01, 0.001, 0.5}, {4.0}),
          effect("thermal_drift", 2, {40.0}, {-3.0, -20.0}),
          effect("thermal_drift", 3, {20.0, 2.0, 0.001}, {-3.0, -20.0}),
          effect("force_gain", 3, {}, {0.1}),
          effect("force_offset", 4, {}, {3.0}),
          effect("delay", 1, {}, {0.004}),
          effect("drive_lag", 2, {}, {0.006}),
          effect("spring", 0, {0.3, 0.0, 0.1, 0.0}, {200.0, 100.0}),
          effect("dashpot", 0, {0.0, 0.3, 0.0, 0.1, 0.5}, {40.0}),
          effect("asymmetric_dashpot", 0, {0.0, 0.3, 0.0, 0.1, 0.5}, {40.0, 10.0}),
          effect("viscoelastic_link", 0, {0.0, 0.3, 0.0, 0.1, 1.0}, {400.0}),
          effect("elastoplastic_link", 0, {0.0, 0.3, 0.0, 0.1, 0.0, 0.004}, {20.0}),
          effect("line_friction", 0, {0.0, 0.1, 0.0, 0.1, 1.8, 0.004}, {10.0}),
          map,
          wheel};
}

/// A slow to and fro along the legs, with a stop; s: time.
WantedInstant wantedAt(const mechanism::Robot& robot, double s) {
  WantedInstant at;
  for (int i = 0; i < 4; ++i) {
    const double w = 2.0 + 0.3 * i;
    at.position_m[i] = robot.actuators[static_cast<std::size_t>(i)].home_length_m + 0.05 + 0.02 * std::sin(w * s);
    at.velocity_m_per_s[i] = 0.02 * w * std::cos(w * s);
    at.acceleration_m_per_s2[i] = -0.02 * w * w * std::sin(w * s);
  }
  return at;
}

mechanism::Pose poseOf(const mechanism::Robot& robot, const mechanism::Vector4& lengths) {
  return mechanism::forwardKinematicsFromHome(*robot.mechanism, lengths).pose;
}

TEST(ActingEffects, LeaveOutByNameWhatMustNotBeFedForward) {
  const mechanism::Robot robot = robotA();
  ModelEffect of_training = effect("screw_ripple", 3, {0.01, 0.0}, {2.0, 1.0});
  of_training.transfers = false;
  ModelEffect of_time = effect("unnamed", 2, {0.0, 10.0}, {1.0, -2.0});
  of_time.depends_on = "time_s_times_direction";
  const ActingEffects effects(
      fake::tracedModelOf(robot, {effect("stribeck", 1, {0.006}, {6.0}), effect("backlash", 2, {1e-3}, {1.0}),
                                  effect("flexible_coupling", 3, {1e5}, {1.0}), of_training, of_time}),
      robot);
  EXPECT_EQ(effects.acting.size(), 1u);
  ASSERT_EQ(effects.left_out.size(), 4u);
  EXPECT_EQ(effects.left_out[0].name, "backlash");
  EXPECT_EQ(effects.left_out[0].where, "axis 2");
  EXPECT_EQ(effects.left_out[3].name, "unnamed (time_s_times_direction)");
  for (const LeftOutEffect& e : effects.left_out)
    EXPECT_FALSE(e.reason.empty());
}

TEST(ActingEffects, TakeTheNumbersForOtherRecordings) {
  const mechanism::Robot robot = robotA();
  Model m = fake::tracedModelOf(robot, {effect("stribeck", 1, {0.006}, {6.0})});
  m.elsewhere.emplace();
  m.elsewhere->parameters = m.elsewhere->effects_see = m.effects_see;
  m.elsewhere->effects = {effect("force_gain", 2, {}, {0.2})};
  const ActingEffects effects(m, robot);
  EXPECT_TRUE(effects.acting.empty());
  EXPECT_EQ(effects.gain[1], 0.2);
}

TEST(ActingEffects, TakeTheNumbersForAControllerAndNameWhatTheseAreFittedWithout) {
  const mechanism::Robot robot = robotA();
  Model m = fake::tracedModelOf(robot, {effect("stribeck", 1, {0.006}, {6.0}), effect("backlash", 3, {1e-4}, {1.0})});
  m.elsewhere = ModelElsewhere{m.effects_see, m.effects_see, m.effects};
  m.feedforward = ModelFeedforward{{m.effects_see, m.effects_see, {effect("force_gain", 2, {}, {0.2})}}, m.friction};
  m.feedforward->numbers.parameters[0] += 1.0;
  m.feedforward->friction[2] = smoothLaw(2e-3);
  const ForceModel model(parseModel(modelToYaml(m), "traced.yaml"), robot);
  EXPECT_TRUE(model.effects.acting.empty());
  EXPECT_EQ(model.effects.gain[1], 0.2);
  ASSERT_EQ(model.effects.left_out.size(), 1u) << "what follows from the state of a drive is given, or not found";
  EXPECT_EQ(model.effects.left_out[0].name, "backlash");
  EXPECT_EQ(model.effects.left_out[0].where, "axis 3");
  EXPECT_EQ(model.parameters[0], m.parameters[0].value + 1.0);
  EXPECT_TRUE(model.friction[2] == smoothLaw(2e-3));
  EXPECT_TRUE(model.friction[1] == m.friction[1]);
}

TEST(ActingEffects, TakeOfNumbersForEachTrainingRecordingThoseForAnyOther) {
  const mechanism::Robot robot = robotA();
  const auto coefficientsOf = [&](const ModelEffect& e) {
    const ActingEffects effects(fake::tracedModelOf(robot, {e}), robot);
    EXPECT_EQ(effects.acting.size(), 1u) << e.name;
    return std::array<double, 2>{effects.acting.at(0).coefficients[0], effects.acting.at(0).coefficients[1]};
  };
  using Two = std::array<double, 2>;
  for (const ModelEffect& ripple : {effect("screw_ripple", 3, {0.01, 0.0}, {}), effect("load_ripple", 3, {0.01}, {})}) {
    const auto with = [&](const std::vector<double>& coefficients) {
      ModelEffect e = ripple;
      for (const double value : coefficients)
        e.coefficients.push_back({"coefficient", value});
      return coefficientsOf(e);
    };
    EXPECT_EQ(with({2.0, 1.0}), (Two{2.0, 1.0}));
    EXPECT_EQ(with({2.0, 1.0, 2.0, 1.0}), (Two{2.0, 1.0})) << "they agree: " << ripple.name;
    EXPECT_NEAR(with({3.0, 0.0, 1.0, 0.0})[0], 2.0 * (1.0 - 2.0 / 8.0), 1e-12) << ripple.name;
  }
  const std::vector<double> how_warm_each_began = {-3.0, -20.0, 0.7, 0.1};
  EXPECT_EQ(coefficientsOf(effect("thermal_drift", 2, {40.0}, how_warm_each_began)), (Two{-3.0, -20.0}));
  EXPECT_EQ(coefficientsOf(effect("thermal_drift", 2, {20.0, 2.0, 0.001}, how_warm_each_began)), (Two{-3.0, -20.0}))
      << "with a law near rest of its own";
}

TEST(ActingEffects, RefuseAnEffectThatIsUnknownOrHasOthersNumbers) {
  const mechanism::Robot robot = robotA();
  EXPECT_THROW(ActingEffects(fake::tracedModelOf(robot, {effect("stick", 1, {}, {1.0})}), robot), InputError);
  EXPECT_THROW(ActingEffects(fake::tracedModelOf(robot, {effect("stribeck", 1, {}, {1.0})}), robot), InputError);
  EXPECT_THROW(ActingEffects(fake::tracedModelOf(robot, {effect("stribeck", 1, {0.01}, {1.0, 2.0})}), robot),
               InputError);
  EXPECT_NO_THROW(ActingEffects(fake::tracedModelOf(robot, {effect("force_gain", 1, {}, {0.79})}), robot));
  EXPECT_THROW(ActingEffects(fake::tracedModelOf(robot, {effect("force_gain", 1, {}, {0.81})}), robot), InputError);
  Model blind = fake::tracedModelOf(robot, {effect("stribeck", 1, {0.01}, {1.0})});
  blind.effects_see.clear();
  EXPECT_THROW(ActingEffects(blind, robot), InputError);
  std::vector<ModelEffect> many(kMostActingEffects + 1, effect("stribeck", 1, {0.01}, {1.0}));
  EXPECT_THROW(ActingEffects(fake::tracedModelOf(robot, many), robot), InputError);
}

TEST(ActingEffects, WarmUpWhileTheDrivesAreOnAndCoolWhileTheyAreOff) {
  const mechanism::Robot robot = robotA();
  const ActingEffects effects(fake::tracedModelOf(robot, {effect("thermal_drift", 2, {40.0}, {-3.0, 0.0})}), robot);
  MotionMemory memory;
  EffectsInstant at;
  at.period_s = 0.001;
  at.share.setOnes();
  double force = 0.0;
  for (int k = 0; k < 40000; ++k)
    force = effectForces(effects, 4, at, memory).friction[1];
  EXPECT_NEAR(force, -3.0 * (1.0 - std::exp(-1.0)), 1e-3);
  rest(effects, 40.0, memory);
  at.period_s = 1e-9;
  EXPECT_NEAR(effectForces(effects, 4, at, memory).friction[1], force * std::exp(-1.0), 1e-3);
}

/// Friction of actuator 2, whose drive has warmed up to it, after a time at one speed.
double warmedUp(const ActingEffects& effects, double velocity_m_per_s, double duration_s, MotionMemory& memory) {
  EffectsInstant at;
  at.period_s = 0.001;
  at.share.setOnes();
  at.velocity_m_per_s[1] = velocity_m_per_s;
  double force = 0.0;
  for (int k = 0; k < std::lround(duration_s / at.period_s); ++k)
    force = effectForces(effects, 4, at, memory).friction[1];
  return force;
}

TEST(ActingEffects, WarmUpInMotionAloneWhereTheModelSaysSo) {
  const mechanism::Robot robot = robotA();
  const double by_motion = numberOf(Heat::Motion), by_work = numberOf(Heat::Work);
  for (const double heated_by : {by_motion, by_work}) {
    const ActingEffects effects(
        fake::tracedModelOf(robot, {effect("thermal_drift", 2, {40.0, heated_by, 0.0}, {-3.0, 0.0})}), robot);
    MotionMemory memory;
    const double warm = warmedUp(effects, 0.04, 40.0, memory) / -3.0;
    EXPECT_NEAR(warm, (heated_by == by_work ? 2.0 : 1.0) * (1.0 - std::exp(-1.0)), 1e-3) << "twice at twice 20 mm/s";
    EXPECT_NEAR(warmedUp(effects, 0.0, 40.0, memory) / -3.0, warm * std::exp(-1.0), 1e-3)
        << "the drive is on, but rests";
  }
}

TEST(ActingEffects, WarmUpByTheWorkSoFarAndDoNotCoolAtRest) {
  const mechanism::Robot robot = robotA();
  const double by_the_work_so_far = numberOf(Heat::Worked), viscous_s_per_m = 25.0;  // as much as dry at 40 mm/s
  const ActingEffects effects(
      fake::tracedModelOf(robot,
                          {effect("thermal_drift", 2, {40.0, by_the_work_so_far, viscous_s_per_m, 0.0}, {-3.0, 0.0})}),
      robot);
  MotionMemory memory;
  const double force = warmedUp(effects, 0.04, 10.0, memory);
  EXPECT_NEAR(force, -3.0 * (1.0 - std::exp(-1.0)), 1e-3) << "four times the power of dry friction at 20 mm/s";
  EXPECT_NEAR(warmedUp(effects, 0.0, 40.0, memory), force, 1e-9);
  rest(effects, 400.0, memory);
  EXPECT_NEAR(warmedUp(effects, 0.0, 0.001, memory), force, 1e-9);
}

TEST(ActingEffects, OfALinkRelaxWhileTheDrivesAreOffAndFadeWhereThePlatformRests) {
  mechanism::Motion rises;  // where the line's rate is 0.8 of the platform's
  rises.pose = mechanism::Pose(0.0, 0.4, 0.0, 0.0);
  rises.pose_velocity[1] = 0.05;
  EffectInstant at;
  at.motion = &rises;
  at.period_s = 0.1;
  PoseColumns columns;
  EffectState first, second;
  const auto relaxing = effectLaw("viscoelastic_link", "", {0.3, 0.0, 0.0, 0.0, 2.0});
  relaxing->poseColumns(at, first, columns);
  const double stretched_m = 0.04 * 2.0 * (1.0 - std::exp(-0.05));
  EXPECT_TRUE(columns.col(0).isApprox(stretched_m * mechanism::Vector4(-0.6, 0.8, 0.0, 0.0), 1e-9));
  relaxing->rest(4.0, first);
  EXPECT_NEAR(first.value, stretched_m * std::exp(-2.0), 1e-12);
  const auto yielding = effectLaw("elastoplastic_link", "", {0.3, 0.0, 0.0, 0.0, 0.0, 0.004});
  second.rate = 0.04;  // it came at that rate
  yielding->poseColumns(at, second, columns);
  EXPECT_NEAR(second.value, 1.0 - std::exp(-1.0), 1e-9);
  rises.pose_velocity.setZero();
  second.rate = 0.0;
  at.fade = 0.5;
  yielding->poseColumns(at, second, columns);
  EXPECT_NEAR(columns(1, 0), 0.8 * 0.5 * (1.0 - std::exp(-1.0)), 1e-9);
}

TEST(ActingEffects, RefuseAHeatThatNothingStandsFor) {
  const mechanism::Robot robot = robotA();
  EXPECT_THROW(
      ActingEffects(fake::tracedModelOf(robot, {effect("thermal_drift", 2, {40.0, 0.5, 0.0}, {-3.0, 0.0})}), robot),
      InputError);
  const std::vector<double> cools_as_it_rubs = {40.0, numberOf(Heat::Worked), -30.0, 0.0};
  EXPECT_THROW(
      ActingEffects(fake::tracedModelOf(robot, {effect("thermal_drift", 2, cools_as_it_rubs, {-3.0, 0.0})}), robot),
      InputError);
  const std::vector<double> by_windings = {40.0, numberOf(Heat::Winding), 0.0, 0.0};
  EXPECT_THROW(ActingEffects(fake::tracedModelOf(robot, {effect("thermal_drift", 2, by_windings, {-3.0, 0.0})}), robot),
               InputError)
      << "of the force of a motor, which this law does not know";
}

TEST(ActingEffects, MakeThePartsAddUpToTheWholeForce) {
  const mechanism::Robot robot = robotA();
  const Model model = fake::tracedModelOf(robot, oneOfEach());
  const PartedModel parted(model, robot);
  ASSERT_TRUE(parted.identified->effects.left_out.empty());
  const ForceModel whole(model, robot);
  ForcePartsData parts_data;
  ForceModelData data;
  double largest = 0.0;
  for (int k = 0; k < 8000; ++k) {
    const WantedInstant at = wantedAt(robot, 0.001 * k);
    ForceParts parts;
    const mechanism::Pose pose = poseOf(robot, at.position_m);
    ASSERT_TRUE(forceParts(parted, pose, at, parts_data, parts));
    mechanism::Motion motion;
    motion.pose = pose;
    ASSERT_TRUE(mechanism::poseRates(*robot.mechanism, pose, at.velocity_m_per_s, at.acceleration_m_per_s2,
                                     motion.pose_velocity, motion.pose_acceleration));
    mechanism::Vector4 force;
    ASSERT_TRUE(forceFromModel(whole, at.position_m, at.velocity_m_per_s, at.acceleration_m_per_s2, motion, data, force,
                               at.period_s));
    if (k < 2000) continue;  // the two start half a way apart
    largest = std::max(largest, (parts.gravity + parts.inertia + parts.friction - force).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(largest, 0.05) << "N";
}

TEST(ActingEffects, LetGoOfFrictionWhereTheReferenceRests) {
  const mechanism::Robot robot = robotA();
  const PartedModel model(fake::tracedModelOf(robot, {effect("presliding", 3, {1e-3}, {4.0})}), robot);
  ForcePartsData data;
  ForceParts parts;
  WantedInstant at = wantedAt(robot, 0.0);
  const mechanism::Pose pose = poseOf(robot, at.position_m);
  at.rest_s = 0.3;
  at.acceleration_m_per_s2.setZero();
  at.velocity_m_per_s.setConstant(0.02);
  for (int k = 0; k < 1000; ++k)
    ASSERT_TRUE(forceParts(model, pose, at, data, parts));
  EXPECT_NEAR(parts.friction[2], 15.0 + 4.0 + 150.0 * 0.02, 1e-6);
  at.velocity_m_per_s.setZero();
  ASSERT_TRUE(forceParts(model, pose, at, data, parts));
  EXPECT_NEAR(parts.friction[2], 15.0 + 4.0, 0.1) << "held where the motion turns";
  for (int k = 0; k < 3000; ++k)
    ASSERT_TRUE(forceParts(model, pose, at, data, parts));
  EXPECT_NEAR(parts.friction[2], 0.0, 0.01);
}

TEST(ActingEffects, AllocateNothingWhileTheyRun) {
  const mechanism::Robot robot = robotA();
  const PartedModel model(fake::tracedModelOf(robot, oneOfEach()), robot);
  ForcePartsData data;
  ForceParts parts;
  const WantedInstant at = wantedAt(robot, 0.1);
  const mechanism::Pose pose = poseOf(robot, at.position_m);
  allocations = 0;
  armed = true;
  for (int k = 0; k < 100; ++k)
    forceParts(model, pose, at, data, parts);
  restParts(model, 0.001, data);
  armed = false;
  EXPECT_EQ(allocations, 0);
  EXPECT_TRUE(parts.allFinite());
}

}  // namespace
}  // namespace knee_robot::dynamics
