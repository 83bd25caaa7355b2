#pragma once

#include <array>
#include <string>

#include "controller_action.h"

namespace knee_robot {

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

  Answer play();
  Answer follow(const std::string& phase, bool measure);
  Answer breakOff();
  Answer endRecording(Answer answer);
  void feedBack(const std::string& phase, const ControlStatus& status);
  void measureErrors();
  bool isInterrupted() const { return server_.interruption_ != Interruption::None; }

  PlayActionServer& server_;
  ControlSystem& system_;
  PlayActionServer::Job& job_;
  PlayResult result_;
  std::array<double, kAxes> square_{};  // m^2
  std::uint64_t samples_ = 0;
  ros::WallTime fed_back_;
};

}  // namespace knee_robot
