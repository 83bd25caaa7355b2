// An arm of six joints, more than the robot with legs has: what is looked for has as many actuators as the machine.

#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "knee_robot/identification/recording_units.h"
#include "knee_robot/tracing/trace.h"
#include "test/identification/chain_motion.h"

namespace knee_robot::tracing {
namespace {

constexpr int kJoints = 6;

mechanism::Robot armOfSixJoints() {
  const TemporaryFolder folder;
  std::ofstream urdf(folder / "arm.urdf");
  std::ofstream robot(folder / "robot.yaml");
  urdf << "<robot name=\"arm\"><link name=\"link_0\"/>";
  robot << "mechanism: chain\nurdf: arm.urdf\nbase_link: link_0\ntip_link: link_" << kJoints << "\njoints: [";
  for (int i = 1; i <= kJoints; ++i) {
    urdf << "<joint name=\"joint_" << i << "\" type=\"continuous\"><parent link=\"link_" << i - 1
         << "\"/><child link=\"link_" << i << "\"/><origin xyz=\"0.05 0 0.2\"/><axis xyz=\""
         << (i % 2 == 0 ? "0 1 0" : "1 0 0") << "\"/></joint><link name=\"link_" << i
         << "\"><inertial><origin xyz=\"0.02 0.01 0.1\"/><mass value=\"" << 4.0 - 0.5 * i
         << "\"/><inertia ixx=\"0.02\" ixy=\"0\" ixz=\"0\" iyy=\"0.02\" iyz=\"0\" izz=\"0.01\"/></inertial></link>";
    robot << (i > 1 ? ", " : "") << "{name: joint_" << i << ", resolution_rad: 1.0e-6}";
  }
  urdf << "</robot>";
  robot << "]\n";
  urdf.close();
  robot.close();
  return mechanism::loadAnyRobot((folder / "robot.yaml").string());
}

TEST(LongChain, AnArmOfSixJointsIsTracedToTheEndAndStaysClean) {
  mechanism::Robot robot = armOfSixJoints();
  std::vector<recording::Recording> recordings;
  std::mt19937 dice(3);
  std::normal_distribution<double> noise(0.0, 0.05);
  for (const int seed : {1, 2}) {
    recordings.push_back(identification::armRecording(robot, seed));
    recordings.back().force_N = recordings.back().force_N.unaryExpr([&](double f) { return f + noise(dice); });
  }
  identification::adaptToRecordings(robot, recordings);
  ASSERT_EQ(robot.axes(), kJoints);
  TraceOptions options;
  options.fast_band = false;
  options.maps = false;
  options.observation.setCutoff(3.0);
  std::vector<identification::Observation> training;
  for (recording::Recording& r : recordings) {
    identification::toActuatorUnits(robot, r);
    training.push_back(identification::observe(robot, identification::columnsOf(robot), r, options.observation));
  }
  EXPECT_TRUE(trace(robot, recordings, training, options).effects.empty());
}

}  // namespace
}  // namespace knee_robot::tracing
