#include "../../src/nodes/bag_import.h"

#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <knee_robot/Tracking.h>
#include <rosbag/bag.h>
#include <sensor_msgs/JointState.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "knee_robot/base/errors.h"
#include "knee_robot/recording/recording.h"

namespace knee_robot::nodes {
namespace {

/// A bag with 50 tracking messages 10 ms apart (one of them twice), joint states, and pictures 4 ms after every second
/// message.
class BagImport : public ::testing::Test {
 protected:
  BagImport() : path_(testing::TempDir() + "bag_import_" + std::to_string(getpid()) + ".bag") {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    for (int k = 0; k < 50; ++k) {
      const ros::Time stamp = ros::Time(1700000000, 0) + ros::Duration(0.01 * k);
      Tracking t;
      t.header.stamp = stamp;
      sensor_msgs::JointState joints;
      joints.header.stamp = stamp;
      for (std::size_t i = 0; i < 4; ++i) {
        t.reference_m[i] = 0.7;
        t.position_m[i] = 0.6 + 0.001 * k + 0.01 * static_cast<double>(i);
        t.command_V[i] = 1.0;
        t.force_N[i] = 100.0 + k;
        joints.name.push_back("axis" + std::to_string(i));
        joints.position.push_back(t.position_m[i]);
        joints.effort.push_back(5.0);
      }
      bag.write("/controller/tracking", stamp, t);
      if (k == 20) bag.write("/controller/tracking", stamp, t);
      bag.write("/joints", stamp, joints);
      if (k % 2) continue;
      geometry_msgs::PoseStamped picture;
      picture.header.stamp = stamp + ros::Duration(0.004);
      picture.pose.position.x = 0.1;
      picture.pose.position.z = 0.8;
      picture.pose.orientation.y = std::sin(0.1);  // theta = 0.2
      picture.pose.orientation.w = std::cos(0.1);
      bag.write("/camera", picture.header.stamp, picture);
    }
    bag.close();
    source_.path = path_;
  }
  ~BagImport() override { std::remove(path_.c_str()); }

  std::string message() const {
    try {
      importBag(source_);
    } catch (const InputError& e) {
      return e.what();
    }
    return "nothing was refused";
  }

  std::string path_;
  BagSource source_;
};

TEST_F(BagImport, TakesTheControllersTopicByItsStampsAndSaysSo) {
  const recording::Imported imported = importBag(source_);
  const recording::Recording r = recording::parseRecording(imported.csv, "imported");
  ASSERT_EQ(r.rows(), 50);
  EXPECT_EQ(r.axes, 4);
  EXPECT_NEAR(r.time_s[49], 0.49, 1e-9);
  EXPECT_DOUBLE_EQ(r.position_m(3, 1), 0.6 + 0.003 + 0.01);
  EXPECT_DOUBLE_EQ(r.force_N(7, 0), 107.0);
  ASSERT_FALSE(imported.notes.empty());
  EXPECT_NE(imported.notes[0].find("1 with the stamp of another"), std::string::npos) << imported.notes[0];
  EXPECT_NE(imported.notes[0].find("Nothing was resampled"), std::string::npos);
}

TEST_F(BagImport, PutsPicturesBesideTheNearestRows) {
  source_.camera = "/camera";
  const recording::Recording r = recording::parseRecording(importBag(source_).csv, "imported");
  ASSERT_EQ(r.mocap.cols(), 4);
  EXPECT_NEAR(r.mocap(4, 2), 0.2, 1e-9);
  EXPECT_DOUBLE_EQ(r.mocap(4, 1), 0.8);
  EXPECT_TRUE(std::isnan(r.mocap(5, 0)));
}

TEST_F(BagImport, TakesJointStatesOfOtherMachines) {
  source_.topic = "/joints";
  source_.joints = {"axis2", "axis0"};
  const recording::Recording r = recording::parseRecording(importBag(source_).csv, "imported");
  EXPECT_EQ(r.axes, 2);
  EXPECT_DOUBLE_EQ(r.position_m(0, 0), 0.62);
  EXPECT_DOUBLE_EQ(r.force_N(0, 1), 5.0);
}

TEST_F(BagImport, NamesWhatIsThereWhenATopicIsNot) {
  source_.topic = "/nowhere";
  EXPECT_NE(message().find("/controller/tracking (knee_robot/Tracking)"), std::string::npos) << message();
  source_.topic = "/camera";
  EXPECT_NE(message().find("neither"), std::string::npos) << message();
  source_.topic = "/joints";
  EXPECT_NE(message().find("--joints"), std::string::npos) << message();
  source_.joints = {"axis7"};
  EXPECT_NE(message().find("axis7"), std::string::npos) << message();
}

TEST_F(BagImport, RefusesWhatIsNoBag) {
  source_.path = KNEE_SOURCE_DIR "/README.md";
  EXPECT_NE(message().find("README.md"), std::string::npos);
}

}  // namespace
}  // namespace knee_robot::nodes
