#include "knee_robot/tracing/pose_registration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "knee_robot/base/errors.h"
#include "knee_robot/mechanism/kinematics.h"
#include "test/mechanism/configured_robot.h"

namespace knee_robot::tracing {
namespace {

mechanism::Pose poseAt(double t) {
  return {0.02 + 0.05 * std::sin(0.7 * t) + 0.01 * std::sin(2.3 * t), 0.78 + 0.06 * std::sin(0.5 * t + 1.0),
          0.05 + 0.14 * std::sin(0.8 * t + 2.0), 0.12 * std::sin(0.63 * t) + 0.03 * std::sin(1.9 * t)};
}

recording::Recording recorded(const mechanism::Robot& robot, double seconds) {
  recording::Recording r;
  r.path = r.name = "run";
  r.axes = 4;
  r.position_m.resize(static_cast<Eigen::Index>(100 * seconds), 4);
  for (Eigen::Index n = 0; n < r.position_m.rows(); ++n) {
    r.time_s.push_back(0.01 * static_cast<double>(n));
    r.position_m.row(n) = mechanism::legLengths(*robot.mechanism, poseAt(r.time_s.back())).transpose();
  }
  return r;
}

/// A capture at 120 pictures a second that starts `early_s` before the recording, with a clock of its own and a frame
/// whose second axis points up.
recording::MarkerPoses captured(double seconds, double early_s, double clock_s,
                                const Eigen::Isometry3d& robot_in_capture) {
  recording::MarkerPoses c;
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (double t = -early_s; t < seconds; t += 1.0 / 120.0) {
    const mechanism::Pose pose = poseAt(t);
    Eigen::Isometry3d platform = Eigen::Isometry3d::Identity();
    platform.linear() = mechanism::platformRotation(pose);
    platform.translation() << pose[0], 0.0, pose[1];
    platform.translation() += 1e-4 * Eigen::Vector3d(noise(random), noise(random), noise(random));
    platform.linear() =
        platform.linear() * Eigen::AngleAxisd(5e-4 * noise(random), Eigen::Vector3d::UnitX()).toRotationMatrix();
    c.time_s.push_back(t + clock_s);
    c.pose.push_back(robot_in_capture * platform);
    c.known.push_back(c.time_s.size() % 40 != 0);
  }
  return c;
}

Eigen::Isometry3d yUp() {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  frame.linear() =
      (Eigen::AngleAxisd(-M_PI / 2.0, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  frame.translation() << 1.2, 0.4, -2.0;
  return frame;
}

TEST(PoseRegistration, FindsClockAndFrameOfACaptureThatKnowsNeither) {
  const mechanism::Robot robot = mechanism::configuredRobot("B");
  const recording::Recording r = recorded(robot, 30.0);
  const RegisteredCapture c = registerCapture(robot, r, captured(34.0, 3.7, 81234.56, yUp()), 60.0);
  EXPECT_NEAR(c.delay_s, 81234.56, 2e-3);
  EXPECT_GT(c.correlation, 0.95);
  EXPECT_LT((c.frame.matrix() - yUp().inverse().matrix()).cwiseAbs().maxCoeff(), 3e-3);
  EXPECT_LT(c.rms_m, 1e-3);
  EXPECT_LT(c.out_of_plane_m, 5e-4);
  EXPECT_GT(c.pictures, 0.9 * r.rows());
  double worst = 0.0;
  for (int n = 0; n < r.rows(); ++n) {
    if (!c.pose.row(n).allFinite()) continue;
    worst = std::max(worst,
                     (c.pose.row(n).transpose() - poseAt(r.time_s[static_cast<std::size_t>(n)])).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 4e-3);
  ASSERT_EQ(c.notes.size(), 3u);  // time, frame, what the mechanism cannot do
}

TEST(PoseRegistration, RefusesACaptureOfAnotherMovement) {
  const mechanism::Robot robot = mechanism::configuredRobot("B");
  recording::MarkerPoses other = captured(30.0, 0.0, 0.0, yUp());
  for (std::size_t k = 0; k < other.pose.size(); ++k) {
    const double t = other.time_s[k];
    other.pose[k].translation() = Eigen::Vector3d(0.3 * std::sin(5.1 * t * t / 30.0), 0.0, 0.2);
    other.pose[k].linear().setIdentity();
  }
  EXPECT_THROW(registerCapture(robot, recorded(robot, 30.0), other, 60.0), Refusal);
}

}  // namespace
}  // namespace knee_robot::tracing
