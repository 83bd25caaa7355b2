#include "../../src/nodes/monitor_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "../../src/nodes/controller_messages.h"
#include "../../src/nodes/controller_pose.h"
#include "../../src/nodes/monitor_board.h"

namespace knee_robot::nodes {
namespace {

class MonitorScene : public testing::Test {
 protected:
  static std::string allText(const visualization_msgs::MarkerArray& scene, const std::string& subject) {
    std::string text;
    for (const auto& marker : scene.markers)
      text += marker.ns == subject ? marker.text + "\n" : "";
    return text;
  }

  const mechanism::Robot robot_ = mechanism::loadRobot(KNEE_SOURCE_DIR "/config/robots/final.yaml");
  Heard heard_;
};

TEST_F(MonitorScene, APoseComesBackFromItsMessage) {
  for (const mechanism::Pose& pose : {mechanism::Pose(0.1, 0.7, 0.2, -0.3), mechanism::Pose(-0.05, 0.65, -0.5, 0.4),
                                      mechanism::Pose(0.0, 0.6, 0.0, 0.0)})
    EXPECT_LT((poseOf(poseMessage(pose)) - pose).norm(), 1e-12);
}

TEST_F(MonitorScene, SaysThatNobodyIsHeard) {
  EXPECT_NE(std::string::npos, allText(sceneOf(robot_, heard_), "text").find("silent"));
}

TEST_F(MonitorScene, ShowsTheFaultInRedWithItsCause) {
  heard_.state.emplace();
  heard_.state->fault = "following_error";
  heard_.state->cause = "axis 2: too far from the reference";
  const auto scene = sceneOf(robot_, heard_);
  EXPECT_NE(std::string::npos, allText(scene, "text").find("FAULT following_error\naxis 2"));
  EXPECT_EQ(kBad.r, scene.markers.front().color.r);
}

TEST_F(MonitorScene, ShowsAnUnexpectedForceAsAnArrowAndSaysWhatItMeans) {
  heard_.state.emplace();
  heard_.residual.emplace();
  heard_.residual->known = heard_.residual->identified = true;
  heard_.residual->wrench = {0.0, -100.0, 0.0, 0.0};
  heard_.residual->wrench_band = {10.0, 10.0, 1.0, 1.0};
  heard_.residual->pose = {0.0, 0.7, 0.0, 0.0};
  heard_.residual->warnings = {"someone pushes"};
  const auto arrowOf = [&] {
    const auto scene = sceneOf(robot_, heard_);
    const auto found = std::find_if(scene.markers.begin(), scene.markers.end(), [](const auto& marker) {
      return marker.ns == "residual" && marker.type == visualization_msgs::Marker::ARROW;
    });
    return found == scene.markers.end() ? visualization_msgs::Marker() : *found;
  };
  ASSERT_EQ(2U, arrowOf().points.size());
  EXPECT_NEAR(0.7, arrowOf().points[0].z, 1e-9);
  EXPECT_LT(arrowOf().points[1].z, 0.65);
  EXPECT_NE(std::string::npos, allText(sceneOf(robot_, heard_), "residual").find("someone pushes"));
  heard_.residual->wrench = {0.0, -9.0, 0.0, 0.0};
  EXPECT_TRUE(arrowOf().points.empty()) << "within the band";
}

TEST_F(MonitorScene, ShowsOnlyThePathToCome) {
  heard_.path.emplace();
  for (int k = 0; k <= 10; ++k) {
    heard_.path->poses.emplace_back();
    heard_.path->poses.back().header.stamp.fromSec(k);
    heard_.path->poses.back().pose = poseMessage(mechanism::Pose(0.0, 0.6 + 0.01 * k, 0.0, 0.0));
  }
  const auto points = [&] {
    const auto scene = sceneOf(robot_, heard_);
    const auto line = std::find_if(scene.markers.begin(), scene.markers.end(),
                                   [](const visualization_msgs::Marker& marker) { return marker.ns == "path"; });
    return line == scene.markers.end() ? 0 : line->points.size();
  };
  heard_.state.emplace();
  heard_.state->reference_file = "a.txt";
  EXPECT_EQ(11u, points());
  heard_.state->playing = "a.txt";
  heard_.state->path_time_s = 6.5;
  EXPECT_EQ(4u, points());
  heard_.state->playing = "the approach to a.txt";
  EXPECT_EQ(11u, points());
}

TEST_F(MonitorScene, NumbersEveryMarkerOnce) {
  heard_.state.emplace();
  heard_.tracking.emplace();
  control::TrackingRow row;
  row.position_m = {0.7, 0.7, 0.7, 0.7};
  const mechanism::Pose pose(0.0, 0.7, 0.1, 0.1);
  heard_.reference = pose;
  heard_.margins = marginsMessage(robot_, &pose, row);
  std::set<std::pair<std::string, int>> seen;
  const auto scene = sceneOf(robot_, heard_);
  for (const auto& marker : scene.markers)
    EXPECT_TRUE(seen.emplace(marker.ns, marker.id).second) << marker.ns << marker.id;
  EXPECT_GT(seen.size(), 60u);
}

TEST(Messages, NameTheNearestLimit) {
  const mechanism::Robot robot = mechanism::loadRobot(KNEE_SOURCE_DIR "/config/robots/final.yaml");
  control::TrackingRow row;
  row.position_m = {0.75, 0.75, 0.8999, 0.75};
  const Margins margins = marginsMessage(robot, nullptr, row);
  EXPECT_FALSE(margins.pose_known);
  EXPECT_EQ("longest length of leg 3", margins.nearest);
  EXPECT_NEAR(0.0001 / 0.3, margins.nearest_left, 1e-9);
}

TEST(Messages, CoordinatesHaveTheRatesOfTheirDifferences) {
  const mechanism::Robot robot = mechanism::loadRobot(KNEE_SOURCE_DIR "/config/robots/final.yaml");
  const mechanism::Pose pose(0.02, 0.7, 0.1, -0.2), rate(0.03, -0.02, 0.1, 0.2);
  constexpr double h = 1e-6;
  const mechanism::Vector4 length_rate = mechanism::lengthJacobian(*robot.mechanism, pose) * rate;
  control::TrackingRow row;
  std::copy_n(length_rate.data(), 4, row.velocity_m_per_s.begin());
  const auto now = coordinatesMessage(*robot.mechanism, pose, row);
  const auto after = coordinatesMessage(*robot.mechanism, pose + h * rate, row);
  const auto before = coordinatesMessage(*robot.mechanism, pose - h * rate, row);
  ASSERT_EQ(15u, now.velocity.size());
  for (std::size_t i = 0; i < 15; ++i)
    EXPECT_NEAR((after.position[i] - before.position[i]) / (2 * h), now.velocity[i], 1e-8) << now.name[i];
}

TEST(Text, IsWrappedBetweenWords) {
  EXPECT_EQ("one two\nthree", wrapped("one two three", 8));
  EXPECT_EQ("0.00", fixedNumber(-0.001, 2));
  EXPECT_EQ("-0.01", fixedNumber(-0.009, 2));
}

}  // namespace
}  // namespace knee_robot::nodes
