#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <knee_robot/ControllerState.h>
#include <knee_robot/Forces.h>
#include <knee_robot/Margins.h>
#include <knee_robot/Residual.h>
#include <knee_robot/Timing.h>
#include <knee_robot/Tracking.h>
#include <ros/ros.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace knee_robot::nodes {

/// Lines of at most `columns` characters: longer ones are broken at blanks, and go on below the text of their first.
std::vector<std::string> brokenLines(const std::vector<std::string>& lines, std::size_t columns);

/// Listens to controller/{state, tracking, margins, forces, residual, timing} and to the diagnostics, and says them in
/// text.
class TextMonitor {
 public:
  explicit TextMonitor(ros::NodeHandle& node);

  /// State, tracking and margins were heard, and not long ago.
  bool isComplete() const;
  /// Everything, for a screen of 100 columns.
  std::vector<std::string> screen() const;
  /// The same in short.
  std::string line() const;

 private:
  bool isSilent() const;
  void addLegs(std::vector<std::string>& lines) const;
  void addResidual(std::vector<std::string>& lines) const;
  void addTiming(std::vector<std::string>& lines) const;
  void addDiagnostics(std::vector<std::string>& lines) const;
  template <typename Message>
  void listen(ros::NodeHandle& node, const std::string& topic, std::optional<Message>& kept);

  std::optional<ControllerState> state_;
  std::optional<Tracking> tracking_;
  std::optional<Margins> margins_;
  std::optional<Forces> forces_;
  std::optional<Residual> residual_;
  std::optional<Timing> timing_;
  std::map<std::string, diagnostic_msgs::DiagnosticStatus> diagnostics_;
  ros::SteadyTime heard_at_;
  std::string controller_;  // resolved name
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace knee_robot::nodes
