#pragma once

#include <string>
#include <vector>

#include "knee_robot/recording/import.h"

namespace knee_robot::nodes {

/// What to take out of a rosbag.
struct BagSource {
  std::string path;
  std::string topic;                ///< knee_robot/Tracking or sensor_msgs/JointState; empty: the only Tracking topic
  std::vector<std::string> joints;  ///< JointState: the actuators' joints, in order; effort is the force (N)
  std::string camera;  ///< geometry_msgs/PoseStamped topic of the platform in the robot's frame; empty: none
};

/// Makes a recording of a bag. Rows are the topic's messages by their header stamps (counted from the first), in order
/// of time; those with the stamp of another are dropped and counted. A picture goes to the row that is nearest in time.
/// InputError for what cannot be read, a topic that is not there (naming those that are), or another type.
recording::Imported importBag(const BagSource& source);

}  // namespace knee_robot::nodes
