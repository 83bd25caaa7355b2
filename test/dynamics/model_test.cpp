#include "knee_robot/dynamics/model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/rigid_body.h"

namespace knee_robot::dynamics {
namespace {

mechanism::Robot parallelRobot() {
  mechanism::Robot robot;
  robot.path = "r.yaml";
  robot.fingerprint = "00ff";
  mechanism::Geometry g;
  g.R = {0.4, 0.4, 0.4};
  g.ds = 0.15;
  g.beta_FD = M_PI / 2;
  g.beta_FI = M_PI / 4;
  g.Rm = {0.3, 0.3, 0.3};
  g.beta_MD = 0.872664;
  g.beta_MI = M_PI / 2;
  robot.mechanism = mechanism::Mechanism(g);
  robot.actuators.assign(4, mechanism::Actuator());
  return robot;
}

Model someModel(const mechanism::Robot& robot, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Model m;
  m.kind = robot.kind;
  m.axes = robot.axes();
  m.robot_fingerprint = robot.fingerprint;
  m.data = {{"a \"strange\" \\ name.csv", "12ab"}, {"b.csv", "34cd"}};
  m.cutoff_hz = 3.0;
  m.moving_m_per_s = 0.0015;
  m.rank = 28;
  for (int i = 0; i < m.axes; ++i) {
    m.friction.push_back(i == 0   ? stopLaw(1e-5)
                         : i == 1 ? smoothLaw(1e-3)
                         : i == 2 ? bristleLaw(1e-4, 2e-5, 1e-3)
                                  : lawOf({{FrictionKind::Stop, 0.3, 9e-6, 0.0, 0.0, 0.0, 1.0, 5e-5},
                                           {FrictionKind::Stop, 0.6, 1e-4, 0.0, 0.0, 0.0, 1.0, 0.0, 2.5},
                                           {FrictionKind::Smooth, 0.1, 0.0, 1e-3, 0.0, 0.0, 1.0, 0.0, 0.0, 0.02}}));
    m.residual_rms_N.push_back(std::abs(normal(random)));
  }
  const auto names = robot.mechanism ? extendedParameterNames() : axisParameterNames(m.axes);
  for (std::size_t i = 0; i < names.size(); ++i) {
    ModelParameter p;
    p.name = names[i];
    p.unit = "kg m^2";
    p.value = normal(random) / 3.0;
    if (i % 3 == 0) {
      p.std = std::abs(normal(random));
      p.verdict = "weakly identified";
    }
    m.parameters.push_back(p);
  }
  for (int d = 0; d < 3; ++d) {
    BaseParameter b;
    b.value = normal(random);
    b.std = 0.1;
    for (std::size_t i = 0; i < names.size(); ++i)
      b.weights.push_back(normal(random));
    m.base.push_back(b);
  }
  return m;
}

TEST(ModelFile, IsReadBackExactly) {
  const mechanism::Robot robot = parallelRobot();
  Model m = someModel(robot, 1);
  m.fit_motion_cutoff_hz = 42.5;
  m.fit_taut_steps = 1.5;
  const Model r = parseModel(modelToYaml(m), "model.yaml");
  EXPECT_EQ(r.fit_motion_cutoff_hz, 42.5);
  EXPECT_EQ(r.fit_taut_steps, 1.5);
  EXPECT_EQ(r.kind, m.kind);
  EXPECT_EQ(r.rank, m.rank);
  EXPECT_EQ(r.data[0].file, m.data[0].file);
  EXPECT_EQ(r.data[1].fingerprint, "34cd");
  EXPECT_EQ(r.friction, m.friction);
  EXPECT_EQ(r.residual_rms_N, m.residual_rms_N);
  ASSERT_EQ(r.parameters.size(), m.parameters.size());
  for (std::size_t i = 0; i < m.parameters.size(); ++i) {
    EXPECT_EQ(r.parameters[i].name, m.parameters[i].name);
    EXPECT_EQ(r.parameters[i].value, m.parameters[i].value);
    EXPECT_EQ(std::isnan(r.parameters[i].std), std::isnan(m.parameters[i].std));
    EXPECT_EQ(r.parameters[i].verdict, m.parameters[i].verdict);
  }
  ASSERT_EQ(r.base.size(), 3u);
  EXPECT_EQ(r.base[2].weights, m.base[2].weights);
  EXPECT_EQ(modelToYaml(r), modelToYaml(m));
}

TEST(ModelFile, RefusesAFileThatIsCutOffWhereverThatIs) {
  Model traced = someModel(parallelRobot(), 3);
  traced.effects = {{"stribeck", "", {1}, true, {}, {{"peak_N", 1.0, 0.1}}}, {"delay", "", {2}, true, {}, {}}};
  for (const Model& model : {someModel(parallelRobot(), 2), traced}) {
    const std::string whole = modelToYaml(model);
    EXPECT_NO_THROW(parseModel(whole, "m.yaml"));
    for (std::size_t end = whole.rfind("\n", whole.size() - 2); end > whole.find("parameters:");
         end = whole.rfind('\n', end - 1))
      EXPECT_THROW(parseModel(whole.substr(0, end + 1), "m.yaml"), InputError) << whole.substr(end - 40, 40);
  }
}

TEST(ModelFile, OfAnOlderVersionNeedsNoEnd) {
  std::string old = modelToYaml(someModel(parallelRobot(), 2));
  old = "# Force model of a robot, written by identify or trace. SI units." + old.substr(old.find('\n'));
  old.erase(old.size() - 4);
  EXPECT_NO_THROW(parseModel(old, "m.yaml"));
}

TEST(ModelFile, RefusesWhatItDoesNotUnderstand) {
  const std::string good = modelToYaml(someModel(parallelRobot(), 2));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  EXPECT_NO_THROW(parseModel(good, "m.yaml"));
  EXPECT_THROW(parseModel(with("format: 3", "format: 2"), "m.yaml"), InputError);
  EXPECT_THROW(parseModel(with("cutoff_hz", "cutof_hz"), "m.yaml"), InputError);
  EXPECT_THROW(parseModel(with("rank: 28", "rank: many"), "m.yaml"), InputError);
  EXPECT_THROW(parseModel(with("\"Fc_13\"", "\"Fc_99\""), "m.yaml"), InputError);
  EXPECT_THROW(parseModel(with("\"Fc_13\"", "\"Fv_13\""), "m.yaml"), InputError);
  EXPECT_THROW(parseModel(with("axes: 4", "axes: 3"), "m.yaml"), InputError);
  EXPECT_THROW(parseModel(good.substr(0, good.size() / 2), "m.yaml"), InputError);
  EXPECT_THROW(parseModel("", "m.yaml"), InputError);
}

Model withEffects(const mechanism::Robot& robot) {
  Model m = someModel(robot, 6);
  ModelEffect stribeck;
  stribeck.name = "stribeck";
  stribeck.actuators = {2};
  stribeck.shape = {{"velocity_m_per_s", 0.0061}};
  stribeck.coefficients = {{"excess_N", 12.25, 0.5}};
  ModelEffect push;
  push.name = "external_force";
  push.actuators = {1, 2, 3, 4};
  push.transfers = false;
  push.coefficients = {{"force_x_N", -3.5, 0.1}, {"force_z_N", 1e-17, 0.1}};
  ModelEffect map;
  map.name = "unnamed";
  map.actuators = {4};
  map.depends_on = "position_4_m \"and\" more";
  m.effects = {stribeck, push, map};
  return m;
}

TEST(ModelFile, WithEffectsIsAFormatOfItsOwnAndIsReadBackExactly) {
  const Model m = withEffects(parallelRobot());
  const std::string text = modelToYaml(m);
  EXPECT_NE(text.find("format: 4"), std::string::npos);
  const Model r = parseModel(text, "model.yaml");
  ASSERT_EQ(r.effects.size(), 3u);
  EXPECT_EQ(r.effects[0].name, "stribeck");
  EXPECT_EQ(r.effects[0].actuators, std::vector<int>({2}));
  EXPECT_EQ(r.effects[0].shape[0].value, 0.0061);
  EXPECT_TRUE(std::isnan(r.effects[0].shape[0].std));
  EXPECT_EQ(r.effects[0].coefficients[0].std, 0.5);
  EXPECT_TRUE(r.effects[0].transfers);
  EXPECT_FALSE(r.effects[1].transfers);
  EXPECT_EQ(r.effects[1].coefficients[1].value, 1e-17);
  EXPECT_EQ(r.effects[2].depends_on, m.effects[2].depends_on);
  EXPECT_EQ(modelToYaml(r), text);
}

TEST(ModelFile, WithEffectsRefusesUnknownActuatorsAndKeys) {
  const std::string good = modelToYaml(withEffects(parallelRobot()));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  EXPECT_NO_THROW(parseModel(good, "m.yaml"));
  EXPECT_THROW(parseModel(with("{actuator: 2}", "{actuator: 5}"), "m.yaml"), InputError);
  EXPECT_THROW(parseModel(with("transfers: yes", "transfers: perhaps"), "m.yaml"), InputError);
  EXPECT_THROW(parseModel(with("coefficients:", "coeficients:"), "m.yaml"), InputError);
  EXPECT_THROW(parseModel(with("format: 4", "format: 3"), "m.yaml"), InputError);
}

TEST(ModelFile, BelongsToOneRobotFile) {
  mechanism::Robot robot = parallelRobot();
  const Model m = someModel(robot, 3);
  EXPECT_NO_THROW(requireModelOf(m, "m.yaml", robot));
  robot.fingerprint = "beef";
  EXPECT_THROW(requireModelOf(m, "m.yaml", robot), InputError);
  robot.fingerprint = m.robot_fingerprint;
  robot.kind = mechanism::MechanismKind::Axes;
  EXPECT_THROW(requireModelOf(m, "m.yaml", robot), InputError);
}

TEST(ModelFile, KeepsEverySmoothShape) {
  Model m = someModel(parallelRobot(), 2);
  m.friction = {smoothLaw(1e-3, SmoothShape::Rational), smoothLaw(2e-3, SmoothShape::Root),
                smoothLaw(3e-3, SmoothShape::Arctangent), smoothLaw(4e-3, SmoothShape::Ramp)};
  const Model read = parseModel(modelToYaml(m), "m.yaml");
  for (std::size_t i = 0; i < m.friction.size(); ++i)
    EXPECT_TRUE(read.friction[i] == m.friction[i]) << i;
}

TEST(ModelFile, KeepsWhatFrictionHoldsWhenARecordingBeginsAndRefusesMoreThanAllOfIt) {
  Model m = someModel(parallelRobot(), 2);
  m.friction[2].at_start = -0.61;
  const std::string text = modelToYaml(m);
  EXPECT_TRUE(parseModel(text, "m.yaml").friction[2] == m.friction[2]);
  EXPECT_NE(describe(m.friction[2]).find("bent by -61 % of it when a recording begins"), std::string::npos)
      << describe(m.friction[2]);
  std::string more = text;
  more.replace(more.find("at_start: -0.61"), 15, "at_start: -1.61");
  EXPECT_THROW((void)parseModel(more, "m.yaml"), InputError);
}

TEST(ModelFile, KeepsAnExponentAndRefusesItBesideCreep) {
  const mechanism::Robot robot = parallelRobot();
  Model m = someModel(robot, 2);
  m.friction[1] = bristleLaw(1e-4);
  m.friction[1].elements[0].exponent = 1.0 / 0.7;
  m.friction[2] = smoothLaw(1e-3);
  m.friction[2].elements[0].exponent = 3.0;
  m.friction[3] = smoothLaw(2e-3);
  m.friction[3].elements[0].smooth = SmoothShape::Ramp;
  const std::string text = modelToYaml(m);
  EXPECT_TRUE(parseModel(text, "m.yaml").friction[1] == m.friction[1]);
  EXPECT_TRUE(parseModel(text, "m.yaml").friction[2] == m.friction[2]);
  EXPECT_TRUE(parseModel(text, "m.yaml").friction[3] == m.friction[3]);
  std::string creeping = text;
  const std::string still = "speed_m_per_s: 0, damping_s: 0, exponent";
  ASSERT_NE(creeping.find(still), std::string::npos) << text;
  creeping.replace(creeping.find(still), 16, "speed_m_per_s: 1");
  try {
    parseModel(creeping, "m.yaml");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("neither creep nor tremble"), std::string::npos) << e.what();
  }
}

TEST(ModelFile, KeepsAPeakAndRefusesOneThatIsLargerThanTheFrictionItself) {
  const mechanism::Robot robot = parallelRobot();
  Model m = someModel(robot, 3);
  const auto peaked = [](double share) {
    return lawOf({{FrictionKind::Bristles, 1.0 + 2.0 * share, 8e-5},
                  {FrictionKind::Smooth, -share, 0.0, 1e-3},
                  {FrictionKind::Smooth, -share, 0.0, 2e-3}});
  };
  m.friction[0] = peaked(0.25);
  const std::string text = modelToYaml(m);
  EXPECT_DOUBLE_EQ(peakOf(parseModel(text, "m.yaml").friction[0]), 0.5);
  m.friction[0] = peaked(0.49);
  EXPECT_NO_THROW(parseModel(modelToYaml(m), "m.yaml"));
  m.friction[0] = lawOf({{FrictionKind::Bristles, 1.6, 8e-5},
                         {FrictionKind::Bristles, 0.6, 9e-5},
                         {FrictionKind::Smooth, -0.6, 0.0, 1e-3},
                         {FrictionKind::Smooth, -0.6, 0.0, 2e-3}});
  try {
    parseModel(modelToYaml(m), "m.yaml");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("take away 1.2 of the sliding friction"), std::string::npos) << e.what();
  }
}

TEST(ForceFromModel, EqualsTheRegressorTimesTheParametersWhileEveryAxisMovesOn) {
  const mechanism::Robot robot = parallelRobot();
  Model m = someModel(robot, 4);
  m.friction.assign(4, stopLaw(1e-5));
  const ForceModel force_model(m, robot);
  ExtendedParameters parameters;
  for (int i = 0; i < extended::kParameters; ++i)
    parameters[i] = m.parameters[static_cast<std::size_t>(i)].value;
  ForceModelData data;
  RegressorData regressor;
  ExtendedRegressor row;
  // Straight up at 0.1 m/s with some acceleration: all legs lengthen, so that sign(v) is 1 for all.
  for (int k = 0; k < 20; ++k) {
    mechanism::Motion motion;
    motion.pose = mechanism::Pose(0.0, 0.65 + 0.001 * k, 0.05, 0.02);
    motion.pose_velocity = mechanism::Vector4(0.0, 0.1, 0.0, 0.0);
    motion.pose_acceleration = mechanism::Vector4(0.0, 0.3, 0.0, 0.0);
    const mechanism::Vector4 q = mechanism::legLengths(*robot.mechanism, motion.pose);
    ASSERT_TRUE(extendedRegressor(*robot.mechanism, robot.gravity, motion, regressor, row));
    const mechanism::Vector4 v = regressor.motion.lengthVelocity();
    ASSERT_GT(v.minCoeff(), 0.0);
    mechanism::Vector4 force;
    ASSERT_TRUE(forceFromModel(force_model, q, v, regressor.motion.lengthAcceleration(), motion, data, force));
    if (k > 0) {
      EXPECT_LT((force - row * parameters).cwiseAbs().maxCoeff(), 1e-9);
    }
  }
}

TEST(ForceFromModel, TreatsBenchAxesOneByOne) {
  mechanism::Robot robot;
  robot.kind = mechanism::MechanismKind::Axes;
  robot.actuators.assign(2, mechanism::Actuator());
  const Model m = someModel(robot, 5);
  const ForceModel force_model(m, robot);
  ForceModelData data;
  mechanism::Vector4 force = mechanism::Vector4::Zero();
  const mechanism::Vector4 v(0.1, -0.2, 0.0, 0.0), a(1.0, 2.0, 0.0, 0.0);
  forceFromModel(force_model, mechanism::Vector4::Zero(), v, a, {}, data, force);
  forceFromModel(force_model, mechanism::Vector4(0.01, -0.01, 0, 0), v, a, {}, data, force);
  for (int i = 0; i < 2; ++i) {
    const auto p = [&](int k) { return m.parameters[static_cast<std::size_t>(4 * i + k)].value; };
    EXPECT_NEAR(force[i], p(0) * v[i] + p(1) * (v[i] > 0 ? 1.0 : -1.0) + p(2) * a[i] + p(3), 1e-12);
  }
  EXPECT_EQ(force[2], 0.0);
}

}  // namespace
}  // namespace knee_robot::dynamics
