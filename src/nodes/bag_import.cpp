#include "bag_import.h"

#include <geometry_msgs/PoseStamped.h>
#include <knee_robot/Tracking.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/base/words.h"
#include "knee_robot/recording/recording.h"
#include "knee_robot/recording/signals.h"

namespace knee_robot::nodes {
namespace {

constexpr const char* kTracking = "knee_robot/Tracking";
constexpr const char* kJointState = "sensor_msgs/JointState";
constexpr const char* kPose = "geometry_msgs/PoseStamped";

/// Rows before they are written: columns by name, all of one length.
struct BagRows {
  std::vector<std::string> names;
  std::map<std::uint64_t, std::vector<double>> by_stamp_ns;
  int doubled = 0, unstamped = 0;

  void add(const ros::Time& stamp, std::vector<double> values) {
    if (stamp.isZero()) {
      ++unstamped;
      return;
    }
    if (!by_stamp_ns.emplace(stamp.toNSec(), std::move(values)).second) ++doubled;
  }
};

std::string listOf(const std::map<std::string, std::string>& topics) {
  const std::string out = joined(topics, [](const auto& one) { return one.first + " (" + one.second + ")"; });
  return out.empty() ? "none" : out;
}

std::map<std::string, std::string> topicsOf(const rosbag::Bag& bag) {
  std::map<std::string, std::string> out;
  for (const rosbag::ConnectionInfo* connection : rosbag::View(bag).getConnections())
    out[connection->topic] = connection->datatype;
  return out;
}

std::string chosenTopic(const BagSource& source, const std::map<std::string, std::string>& topics) {
  if (!source.topic.empty()) {
    if (topics.count(source.topic) == 0)
      throw InputError(source.path + ": has no topic " + source.topic + "; it has " + listOf(topics));
    return source.topic;
  }
  std::string found;
  for (const auto& [topic, type] : topics) {
    if (type != kTracking) continue;
    if (!found.empty())
      throw InputError(source.path + ": has more than one topic of type " + std::string(kTracking) + ": " + found +
                       " and " + topic + "; choose with --topic");
    found = topic;
  }
  if (found.empty())
    throw InputError(source.path + ": has no topic of type " + std::string(kTracking) + "; choose a " + kJointState +
                     " with --topic and --joints; it has " + listOf(topics));
  return found;
}

void readTracking(const rosbag::Bag& bag, const std::string& topic, BagRows& rows) {
  for (const char* form : {"reference_?_m", "position_?_m", "velocity_?_m_per_s", "command_?_V", "force_?_N"}) {
    for (char axis = '1'; axis <= '4'; ++axis) {
      std::string name = form;
      name[name.find('?')] = axis;
      rows.names.push_back(name);
    }
  }
  for (const rosbag::MessageInstance& item : rosbag::View(bag, rosbag::TopicQuery(topic))) {
    const auto message = item.instantiate<Tracking>();
    if (!message) throw InputError("topic " + topic + " was recorded with another definition of " + kTracking);
    std::vector<double> values;
    for (const auto& field :
         {message->reference_m, message->position_m, message->velocity_m_per_s, message->command_V, message->force_N})
      values.insert(values.end(), field.begin(), field.end());
    rows.add(message->header.stamp, std::move(values));
  }
}

void readJoints(const rosbag::Bag& bag, const std::string& topic, const BagSource& source, BagRows& rows) {
  if (source.joints.empty() || source.joints.size() > 4)
    throw InputError("topic " + topic +
                     " has joint states: name one to four joints with --joints, in the actuators' order");
  for (const char* form : {"position_", "force_"}) {
    for (std::size_t i = 1; i <= source.joints.size(); ++i)
      rows.names.push_back(form + std::to_string(i) + (form[0] == 'p' ? "_m" : "_N"));
  }
  for (const rosbag::MessageInstance& item : rosbag::View(bag, rosbag::TopicQuery(topic))) {
    const auto message = item.instantiate<sensor_msgs::JointState>();
    std::vector<double> position, effort;
    for (const std::string& joint : source.joints) {
      const auto at = std::find(message->name.begin(), message->name.end(), joint) - message->name.begin();
      const auto k = static_cast<std::size_t>(at);
      if (k >= message->name.size() || k >= message->position.size())
        throw InputError(source.path + ": a message of " + topic + " has no position of joint '" + joint + "'");
      if (k >= message->effort.size())
        throw InputError(source.path + ": a message of " + topic + " has no effort (force, N) of joint '" + joint +
                         "'");
      position.push_back(message->position[k]);
      effort.push_back(message->effort[k]);
    }
    position.insert(position.end(), effort.begin(), effort.end());
    rows.add(message->header.stamp, std::move(position));
  }
}

/// Pictures to the nearest rows; the number that was used.
int readCamera(const rosbag::Bag& bag, const BagSource& source, BagRows& rows) {
  for (const char* name : {"mocap_x_m", "mocap_z_m", "mocap_theta_rad", "mocap_psi_rad"})
    rows.names.push_back(name);
  for (auto& [stamp, values] : rows.by_stamp_ns)
    values.resize(values.size() + 4, std::numeric_limits<double>::quiet_NaN());
  int used = 0;
  for (const rosbag::MessageInstance& item : rosbag::View(bag, rosbag::TopicQuery(source.camera))) {
    const auto message = item.instantiate<geometry_msgs::PoseStamped>();
    const std::uint64_t stamp = message->header.stamp.toNSec();
    auto row = rows.by_stamp_ns.lower_bound(stamp);
    if (row == rows.by_stamp_ns.end() ||
        (row != rows.by_stamp_ns.begin() && stamp - std::prev(row)->first < row->first - stamp)) {
      if (row == rows.by_stamp_ns.begin()) continue;
      --row;
    }
    const auto& q = message->pose.orientation;
    double* cell = &row->second[row->second.size() - 4];
    cell[0] = message->pose.position.x;
    cell[1] = message->pose.position.z;
    // Rotation eq. (5): theta about Y, then psi about Z.
    cell[2] = std::atan2(2.0 * (q.x * q.z + q.w * q.y), 1.0 - 2.0 * (q.x * q.x + q.y * q.y));
    cell[3] = std::atan2(2.0 * (q.x * q.y + q.w * q.z), 1.0 - 2.0 * (q.x * q.x + q.z * q.z));
    ++used;
  }
  return used;
}

recording::Imported written(const BagRows& rows, const std::string& topic) {
  recording::Imported out;
  out.csv = "time_s";
  for (const std::string& name : rows.names)
    out.csv += "," + name;
  out.csv += "\n";
  const std::uint64_t first = rows.by_stamp_ns.begin()->first;
  std::vector<double> time;
  for (const auto& [stamp, values] : rows.by_stamp_ns) {
    time.push_back(1e-9 * static_cast<double>(stamp - first));
    out.csv += exactNumber(time.back());
    for (const double value : values)
      out.csv += "," + (std::isnan(value) ? std::string("nan") : exactNumber(value));
    out.csv += "\n";
  }
  out.rows = static_cast<int>(time.size());
  double longest = 0.0;
  for (std::size_t k = 1; k < time.size(); ++k)
    longest = std::max(longest, time[k] - time[k - 1]);
  out.notes.push_back("Rows are the messages of " + topic + " by their header stamps, counted from the first (" +
                      std::to_string(first / 1000000000u) + " s): " + std::to_string(out.rows) + " rows, median " +
                      shortNumber(1e3 * recording::medianPeriod(time), 4) + " ms, longest " +
                      shortNumber(1e3 * longest, 4) + " ms apart. " + std::to_string(rows.doubled) +
                      " with the stamp of another and " + std::to_string(rows.unstamped) +
                      " without stamp were dropped. Nothing was resampled, no signal was shifted.");
  if (recording::medianPeriod(time) > 0.0101)
    out.notes.push_back(
        "The topic is slower than a recording of the controller itself (set_recording): commands between its messages "
        "are missing, which identification takes for held.");
  return out;
}

}  // namespace

recording::Imported importBag(const BagSource& source) {
  try {
    rosbag::Bag bag;
    bag.open(source.path, rosbag::bagmode::Read);
    const std::map<std::string, std::string> topics = topicsOf(bag);
    const std::string topic = chosenTopic(source, topics);
    BagRows rows;
    const std::string& type = topics.at(topic);
    if (type == kTracking) {
      readTracking(bag, topic, rows);
    } else if (type == kJointState) {
      readJoints(bag, topic, source, rows);
    } else {
      throw InputError(source.path + ": topic " + topic + " is a " + type + ", neither " + kTracking + " nor " +
                       kJointState);
    }
    if (rows.by_stamp_ns.size() < 2)
      throw InputError(source.path + ": topic " + topic + " has fewer than two messages");
    std::string camera;
    if (!source.camera.empty()) {
      if (topics.count(source.camera) == 0 || topics.at(source.camera) != kPose)
        throw InputError(source.path + ": " + source.camera + " is not a topic of type " + kPose + "; it has " +
                         listOf(topics));
      camera = std::to_string(readCamera(bag, source, rows)) + " pictures of " + source.camera +
               " were put beside the rows nearest in time.";
    }
    recording::Imported out = written(rows, topic);
    if (!camera.empty()) out.notes.push_back(camera);
    recording::parseRecording(out.csv, source.path + " (as imported)");
    return out;
  } catch (const rosbag::BagException& e) {
    throw InputError(source.path + ": " + e.what());
  }
}

}  // namespace knee_robot::nodes
