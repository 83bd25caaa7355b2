#pragma once

#include <nav_msgs/Path.h>
#include <ros/ros.h>

#include <mutex>
#include <optional>
#include <string>

#include "folder.h"
#include "knee_robot/control/control_system.h"

namespace knee_robot::nodes {

/// A reference file as the network named it, read and checked.
struct CheckedReference {
  std::optional<control::PlayableReference> playable;  ///< empty: refused
  control::Answer answer;  ///< may be played, with the smallest margin; or the first limit that it breaks
  std::uint32_t points = 0;
  double duration_s = 0.0;
};

/// Reads reference files of one folder, hands them to the controller, and publishes the path of the loaded one:
///
///     ~path   nav_msgs/Path   latched; platform poses in frame `base`, stamp = time along the reference
class References {
 public:
  References(control::ControlSystem& system, const Folder& folder) : system_(system), folder_(folder) {}

  /// Nothing changes. `space`: actuator, platform, relative or empty.
  CheckedReference check(const std::string& file, const std::string& space) const;
  /// Hands over what check() let pass.
  control::Answer load(const CheckedReference& checked);
  /// Path for a new reference file of that plain name in the folder. InputError where there is one.
  std::string newFile(const std::string& name) const { return folder_.newFile(name); }
  /// Whoever is on the robot has changed: a reference that the controller has forgotten is not shown any more.
  void followOccupancy();
  /// Length (s) of the loaded reference; 0: none.
  double loadedDuration() const;

  void advertise(ros::NodeHandle& node);
  /// Before the callback queue of that node handle goes.
  void withdraw();

 private:
  void publishPath(const trajectory::ReferenceCheck& check, double period_s);

  control::ControlSystem& system_;
  const Folder& folder_;
  std::mutex loading_;  // so that what is shown is what was loaded last; before mutex_
  mutable std::mutex mutex_;
  double duration_s_ = 0.0;
  nav_msgs::Path path_;  // kept for a master that was restarted
  ros::Publisher publisher_;
};

}  // namespace knee_robot::nodes
