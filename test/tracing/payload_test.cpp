#include "knee_robot/tracing/payload.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>

#include "knee_robot/dynamics/rigid_body.h"
#include "knee_robot/dynamics/robot_inertia.h"
#include "knee_robot/mechanism/kinematics.h"
#include "knee_robot/recording/recording.h"
#include "knee_robot/simulation/virtual_recording.h"
#include "test/mechanism/configured_robot.h"

namespace knee_robot::tracing {
namespace {

constexpr double kPayloadSeconds = 8.0;

/// Lengths along sines of the pose, at rest at both ends.
Eigen::Matrix<double, Eigen::Dynamic, mechanism::kLegs> lengths(const mechanism::Robot& robot) {
  const double center[] = {0.02, 0.78, 0.05, 0.0}, amplitude[] = {0.06, 0.06, 0.14, 0.12},
               hz[] = {0.31, 0.27, 0.37, 0.29};
  Eigen::Matrix<double, Eigen::Dynamic, mechanism::kLegs> points(static_cast<Eigen::Index>(kPayloadSeconds / 0.02) + 1,
                                                                 mechanism::kLegs);
  for (Eigen::Index k = 0; k < points.rows(); ++k) {
    const double t = 0.02 * static_cast<double>(k);
    const double edge = std::min(1.0, std::min(t, kPayloadSeconds - t) / 3.0);
    const double fade = edge * edge * edge * (10.0 - 15.0 * edge + 6.0 * edge * edge);
    mechanism::Pose pose;
    for (int i = 0; i < 4; ++i) {
      const double w = 2.0 * M_PI * hz[i];
      pose[i] = center[i] + fade * amplitude[i] * (0.75 * std::sin(w * t + i) + 0.25 * std::sin(2.7 * w * t + 2.0 * i));
    }
    points.row(k) = mechanism::legLengths(*robot.mechanism, pose).transpose();
  }
  return points;
}

/// The Simbody plant with the URDF's bodies and these changes of them, traced no further than the baseline.
PayloadTest tested(double payload_kg, const mechanism::Vector3& center, double heavier_rods = 1.0) {
  const mechanism::Robot robot = mechanism::configuredRobot("B");
  dynamics::RobotInertia inertia = dynamics::loadRobotInertia(robot);
  inertia.rotor_mass.setConstant(40.0);
  for (int leg = 0; leg < mechanism::kLegs; ++leg) {
    inertia.links[static_cast<std::size_t>(dynamics::rodLink(leg))].mass *= heavier_rods;
    inertia.links[static_cast<std::size_t>(dynamics::cylinderLink(leg))].mass *= heavier_rods;
  }
  dynamics::LinkParameters platform = dynamics::toParameters(inertia.links[dynamics::kPlatformLink]);
  dynamics::LinkInertia load;
  load.mass = payload_kg;
  load.center = center;
  if (payload_kg > 0.0) platform += dynamics::toParameters(load);
  inertia.links[dynamics::kPlatformLink] = dynamics::fromParameters(platform);
  simulation::VirtualPlantParameters parameters;
  parameters.friction = simulation::equalFriction({150.0, 20.0}, {0.0, 0.0});
  parameters.presliding_m = 1e-5;
  const auto points = lengths(robot);
  const simulation::AxisPath path(points, 0.02);
  const mechanism::ForwardResult home =
      mechanism::forwardKinematicsFromHome(*robot.mechanism, points.row(0).transpose());
  simulation::VirtualPlant plant(*robot.mechanism, robot.gravity, inertia, home.pose, parameters);
  simulation::VirtualRecorder recorder;
  recorder.force_noise_N = 0.5;
  const std::string file = testing::TempDir() + "payload_" + std::to_string(getpid()) + ".csv";
  std::remove(file.c_str());
  simulation::recordVirtualPlant(robot, plant, path, recorder, file);
  const recording::Recording recording = recording::loadRecording(file);
  std::remove(file.c_str());
  const identification::ObservationOptions options;
  std::vector<identification::Observation> training = {
      identification::observe(robot, identification::columnsOf(robot), recording, options)};
  const Stack stack = makeStack(training, options);
  const BaseFit base = fitBase(robot, training, stack, identification::columnsOf(robot));
  const PayloadTest t = testPayload(robot, training, stack, base, base.noise_N);
  std::printf("%s\n  rms: URDF %.2f, with a point mass %.2f, free %.2f\n", t.sentence.c_str(), t.prior_rms,
              t.payload_rms, t.free_rms);
  return t;
}

TEST(Payload, OfFiveAndFifteenKilogramsIsStatedWithItsSizeAndPlace) {
  const mechanism::Vector3 center(0.05, 0.1, 0.0);
  for (const double mass : {5.0, 15.0}) {
    const PayloadTest t = tested(mass, center);
    EXPECT_TRUE(t.stated) << mass;
    EXPECT_NEAR(t.mass_kg, mass, std::max(0.1, 4.0 * t.mass_std_kg));
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT(t.center_std_m[k], 0.05);
      EXPECT_NEAR(t.center_m[k], center[k], std::max(0.02, 4.0 * t.center_std_m[k]));
    }
    EXPECT_NE(t.sentence.find("absorbed"), std::string::npos);
  }
}

TEST(Payload, IsNotSeenOnTheEmptyRobot) {
  const PayloadTest t = tested(0.0, mechanism::Vector3::Zero());
  EXPECT_TRUE(t.tested);
  EXPECT_FALSE(t.stated);
  EXPECT_NEAR(t.mass_kg, 0.0, std::max(0.1, 4.0 * t.mass_std_kg));
  EXPECT_NE(t.sentence.find("none is seen"), std::string::npos) << t.sentence;
}

TEST(Payload, IsNotStatedWhereTheLegsAreHeavierThanTheUrdfSays) {
  const PayloadTest t = tested(0.0, mechanism::Vector3::Zero(), 1.6);
  EXPECT_FALSE(t.stated);
}

}  // namespace
}  // namespace knee_robot::tracing
