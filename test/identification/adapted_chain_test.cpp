// What a chain's recordings tell beyond its robot file: joints that stand, encoders' steps and turns; and what is
// refused in them.

#include <gtest/gtest.h>

#include <cmath>

#include "knee_robot/base/errors.h"
#include "knee_robot/dynamics/chain_regressor.h"
#include "knee_robot/identification/identify.h"
#include "knee_robot/identification/physical_fit.h"
#include "knee_robot/identification/recording_units.h"
#include "test/identification/chain_motion.h"
#include "test/refusal.h"

namespace knee_robot::identification {
namespace {

TEST(AdaptedChain, JointsThatStandAreLockedWhereTheyStand) {
  mechanism::Robot robot = testArm();
  std::vector<recording::Recording> recordings = {armRecording(robot, 1)};
  recording::Recording& r = recordings.front();
  for (const int stands : {0, 3, 4, 5})
    r.position_m.col(stands).setConstant(0.1 * stands);
  adaptToRecordings(robot, recordings);
  ASSERT_EQ(robot.axes(), 2);
  EXPECT_EQ(robot.actuators[0].name, "waist");
  EXPECT_EQ(robot.actuators[1].name, "shoulder");
  EXPECT_NE(r.notes.back().find("elbow at 0.3 rad"), std::string::npos) << r.notes.back();
  toActuatorUnits(robot, r);
  EXPECT_EQ(r.axes, 2);
}

TEST(AdaptedChain, TheShorterChainIsTheLongOneHeldStill) {
  const mechanism::Robot whole = testArm();
  const std::vector<char> lock = {1, 0, 1, 0, 1, 0};
  Eigen::VectorXd at(6), q(6), v = Eigen::VectorXd::Zero(6), a = v;
  at << 0.07, 0.0, -0.6, 0.0, 1.9, 0.0;
  mechanism::Robot part = whole;
  part.chain = mechanism::lockedAt(*whole.chain, lock, at);
  q = at;
  Eigen::VectorXd own(3), own_v(3), own_a(3);
  own << 0.4, -0.8, 1.2;
  own_v << 0.9, -1.1, 0.3;
  own_a << -2.0, 3.0, 1.5;
  for (int k = 0; k < 3; ++k) {
    q[2 * k + 1] = own[k];
    v[2 * k + 1] = own_v[k];
    a[2 * k + 1] = own_a[k];
  }
  dynamics::ChainRegressorData long_one(*whole.chain), short_one(*part.chain);
  dynamics::chainRegressor(*whole.chain, whole.gravity, q, v, a, long_one);
  dynamics::chainRegressor(*part.chain, part.gravity, own, own_v, own_a, short_one);
  const Eigen::VectorXd expected = long_one.regressor * dynamics::chainInertia(whole);
  const Eigen::VectorXd got = short_one.regressor * dynamics::chainInertia(part);
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(got[k], expected[2 * k + 1], 1e-9);
}

TEST(AdaptedChain, TheEncodersStepIsThatOfTheRecordingUnlessTheRobotFileKnowsIt) {
  mechanism::Robot robot = testArm();
  std::vector<recording::Recording> recordings = {armRecording(robot, 1)};
  const double step = 2.5e-4;
  recordings.front().position_m = (recordings.front().position_m / step).array().round() * step;
  robot.actuators[2].resolution_given = true;
  const double given = robot.actuators[2].counts_per_revolution;
  adaptToRecordings(robot, recordings);
  EXPECT_NEAR(robot.actuators[1].metresPerCount() * robot.actuators[1].position_per_m(), step, 1e-9);
  EXPECT_EQ(robot.actuators[2].counts_per_revolution, given);
}

TEST(AdaptedChain, PositionsWithinOneTurnAreFollowedOverTheJump) {
  mechanism::Robot robot = testArm();
  recording::Recording whole = armRecording(robot, 1), wrapped = whole;
  whole.position_m.col(4) *= 4.0;  // the roll joint turns on and on
  for (Eigen::Index k = 0; k < wrapped.position_m.rows(); ++k)
    wrapped.position_m(k, 4) = std::remainder(whole.position_m(k, 4), 2.0 * M_PI);
  ASSERT_GT((whole.position_m - wrapped.position_m).cwiseAbs().maxCoeff(), 1.0) << "it does jump";
  toActuatorUnits(robot, whole);
  toActuatorUnits(robot, wrapped);
  const Eigen::VectorXd apart = whole.position_m.col(4) - wrapped.position_m.col(4);
  EXPECT_LT(apart.maxCoeff() - apart.minCoeff(), 1e-9);
  EXPECT_NE(wrapped.notes.back().find("roll"), std::string::npos);
}

TEST(AdaptedChain, RefusesDegrees) {
  mechanism::Robot robot = testArm();
  recording::Recording r = armRecording(robot, 1);
  r.position_m.col(2) *= 180.0 / M_PI;
  try {
    toActuatorUnits(robot, r);
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("degrees"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("shoulder"), std::string::npos) << e.what();
  }
}

TEST(AdaptedChain, ASlowArmIsFoundAgainToo) {
  mechanism::Robot robot = testArm();
  IdentifyOptions options;
  options.uncertainty = false;
  recording::Recording r = armRecording(robot, 1, 0.02);  // of the usual speed: 5 mrad/s at most
  toActuatorUnits(robot, r);
  std::vector<Observation> training = {observe(robot, columnsOf(robot), r, options.observation)};
  const Identification id = identify(robot, training, options);
  EXPECT_LT(id.model.residual_rms_N[1], 0.02 * id.force_rms_N[1] + 0.5);
}

TEST(AdaptedChain, PhysicalBodiesArePossibleAndPredictAsWell) {
  mechanism::Robot robot = testArm();
  IdentifyOptions options;
  options.uncertainty = false;
  recording::Recording r = armRecording(robot, 1);
  toActuatorUnits(robot, r);
  std::vector<Observation> training = {observe(robot, columnsOf(robot), r, options.observation)};
  const PhysicalFit fit = fitPhysicalChain(robot, identify(robot, training, options));
  ASSERT_EQ(fit.bodies.size(), 6u);
  for (const PhysicalBody& body : fit.bodies) {
    EXPECT_EQ(dynamics::inconsistency(body.fitted), "") << body.name;
    EXPECT_NEAR(body.fitted.mass, body.prior.mass, 0.2 * body.prior.mass)
        << body.name << ": the URDF is the truth here";
  }
}

TEST(AdaptedChain, TimeInMillisecondsIsRefused) {
  mechanism::Robot robot = testArm();
  recording::Recording r = armRecording(robot, 1);
  for (double& t : r.time_s)
    t *= 1000.0;
  const std::string said = refusalOf([&] { toActuatorUnits(robot, r); });
  EXPECT_NE(said.find("time_s: a row comes every"), std::string::npos) << said;
  EXPECT_NE(said.find("milliseconds?"), std::string::npos) << said;
}

}  // namespace
}  // namespace knee_robot::identification
