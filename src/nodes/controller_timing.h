#pragma once

#include <ros/ros.h>

#include "knee_robot/control/control_system.h"

namespace knee_robot::nodes {

/// How the controller keeps its time, for a topic and for the log.
///
///     ~timing_histograms   knee_robot/TimingHistograms   every 10 s, latched: period, lateness, execution time
///     log                  the same as a table of median, 99 % and largest, every 10 min
class ControllerTiming {
 public:
  /// `node`: the private namespace; its callback queue carries the timer.
  ControllerTiming(ros::NodeHandle& node, const control::ControlSystem& system);

 private:
  void publish();

  const control::ControlSystem& system_;
  ros::Publisher histograms_;
  ros::SteadyTime logged_at_;
  ros::SteadyTimer timer_;  // last: goes first
};

}  // namespace knee_robot::nodes
