#include "knee_robot/identification/gain_verdicts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "knee_robot/identification/columns.h"
#include "test/identification/chain_motion.h"

namespace knee_robot::identification {
namespace {

/// The arm with gains of 10 N m/A that are known to `std`, and a model of it in which everything is identified.
mechanism::Robot armWithGains(double std) {
  mechanism::Robot robot = testArm();
  for (mechanism::Actuator& a : robot.actuators) {
    a.recorded = mechanism::Recorded::Current;
    a.torque_per_ampere = 10.0;
    a.torque_per_ampere_std = std;
  }
  return robot;
}

dynamics::Model identifiedModel(const mechanism::Robot& robot) {
  dynamics::Model model;
  for (const Column& c : columnsOf(robot)) {
    dynamics::ModelParameter p;
    p.name = c.name;
    p.value = 1.0;
    p.std = 0.01;
    p.verdict = "identified";
    model.parameters.push_back(p);
  }
  return model;
}

std::string verdictOn(const std::string& name, double std) {
  const mechanism::Robot robot = armWithGains(std);
  dynamics::Model model = identifiedModel(robot);
  judgeByGains(robot, model);
  for (const dynamics::ModelParameter& p : model.parameters) {
    if (p.name == name) return p.verdict;
  }
  return "no such parameter";
}

TEST(GainVerdicts, FrictionIsNoBetterKnownThanTheGainItRestsOn) {
  for (const char* name : {"Fv_1", "Fc_6", "rotor_3", "offset_2"}) {
    EXPECT_EQ(verdictOn(name, 0.5), "identified");
    EXPECT_EQ(verdictOn(name, 2.0), "weakly identified");
    for (const double unknown : {6.0, 1e9, std::numeric_limits<double>::infinity(), std::nan("")})
      EXPECT_EQ(verdictOn(name, unknown), "in units of an unknown gain");
    EXPECT_EQ(verdictOn(name, 0.0), "identified") << "a gain that the robot file gives";
  }
}

TEST(GainVerdicts, GainsAreSaidWithTheirIntervalsAndWhatTheyRestOn) {
  const std::vector<std::string> known = aboutGains(armWithGains(0.5)), unknown = aboutGains(armWithGains(1e9));
  ASSERT_EQ(known.size(), 7u);
  EXPECT_NE(known[1].find("10 N m/A, 95 % interval 9.02 to 10.98"), std::string::npos) << known[1];
  EXPECT_NE(known.back().find("URDF"), std::string::npos);
  EXPECT_NE(unknown.front().find("do not determine"), std::string::npos) << unknown.front();
  EXPECT_TRUE(aboutGains(armWithGains(0.0)).empty());
}

TEST(GainVerdicts, AModelWithAGainThatIsNotDeterminedIsReadBack) {
  for (const double std : {5.2e9, std::numeric_limits<double>::infinity(), std::nan("")}) {
    const mechanism::Robot robot = armWithGains(std);
    dynamics::Model model = identifiedModel(robot);
    model.kind = robot.kind;
    model.axes = robot.axes();
    model.joints = dynamics::modelJoints(robot);
    model.robot_fingerprint = robot.fingerprint;
    model.data = {{"none.csv", "0"}};
    model.rank = 1;
    model.moving_m_per_s = 0.0015;
    model.cutoff_hz = 3.0;
    model.friction.assign(robot.actuators.size(), dynamics::stopLaw(1e-5));
    for (std::size_t i = 0; i < robot.actuators.size(); ++i)
      model.friction[i].revolute = robot.actuators[i].revolute;
    model.residual_rms_N.assign(robot.actuators.size(), 0.0);
    judgeByGains(robot, model);
    const dynamics::Model read = dynamics::parseModel(dynamics::modelToYaml(model), "model.yaml");
    EXPECT_GT(read.joints.front().torque_per_ampere_std, 1e9);
    EXPECT_EQ(read.parameters.back().verdict, "in units of an unknown gain");
  }
}

}  // namespace
}  // namespace knee_robot::identification
