#pragma once

#include <array>
#include <string>

#include "controller_action.h"

namespace knee_robot::nodes {

/// "recording_DATE_TIME.csv".
std::string nameAfterTheTime();

/// One goal of the action `~play`, from acceptance to result. Runs in the server's thread.
class PlayedGoal {
 public:
  PlayedGoal(PlayActionServer& server, PlayActionServer::Job& job)
      : server_(server), system_(server.system_), job_(job) {}

  /// Returns when the goal has got its result.
  void run();

 private:
  using Interruption = PlayActionServer::Interruption;

  control::Answer play();
  control::Answer approach(double speed_percent, control::PathExpectation& as_asked);
  double fastestAllowed() const;
  control::Answer follow(const std::string& phase, bool measure);
  control::Answer breakOff();
  control::Answer endRecording(control::Answer answer);
  void feedBack(const std::string& phase, const control::ControlStatus& status);
  void measureErrors();
  bool isInterrupted() const { return server_.interruption_ != Interruption::None; }

  PlayActionServer& server_;
  control::ControlSystem& system_;
  PlayActionServer::Job& job_;
  PlayResult result_;
  std::string name_;                              // of the goal's reference
  std::array<double, hardware::kAxes> square_{};  // m^2
  std::uint64_t samples_ = 0;
  ros::SteadyTime fed_back_;
};

}  // namespace knee_robot::nodes
