#include "played_goal.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

#include "knee_robot/base/numbers.h"
#include "terminal.h"

namespace knee_robot::nodes {
namespace {

constexpr auto kPoll = std::chrono::milliseconds(10);
constexpr double kFeedbackPeriod = 0.1;  // s
constexpr double kLongestStop = 30.0;    // s, from the largest speed to rest, with room
constexpr double kApproachSpeed = 0.01;  // m/s

}  // namespace

std::string nameAfterTheTime() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char name[64];
  std::strftime(name, sizeof name, "recording_%Y-%m-%d_%H-%M-%S.csv", &local);
  return name;
}

void PlayedGoal::run() {
  const control::Answer answer = endRecording(play());
  result_.success = answer.ok;
  result_.message = answer.sentence;
  if (samples_ > 0) {
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      result_.rms_error_m[i] = std::sqrt(square_[i] / static_cast<double>(samples_));
  }
  server_.note("ended", job_.handle, answer.sentence);
  showOutcome("play", answer);
  if (answer.ok) return job_.handle.setSucceeded(result_, answer.sentence);
  const Interruption why = server_.interruption_;
  if (why == Interruption::Cancelled || why == Interruption::Preempted)
    return job_.handle.setCanceled(result_, answer.sentence);
  job_.handle.setAborted(result_, answer.sentence);
}

control::Answer PlayedGoal::play() {
  const PlayGoal& goal = *job_.handle.getGoal();
  if (system_.halts() != job_.wishes.halts)
    return {false,
            "somebody has stopped the robot, or changed who is on it, before this goal began; nothing moved for it"};
  if (system_.state() == control::MachineState::Disabled) {
    if (!goal.enable) return {false, "the robot is disabled; enable it first, or say enable in the goal"};
    feedBack("enabling", system_.status());
    if (const control::Answer answer = system_.enable(job_.wishes.halts); !answer.ok) return answer;
  }
  if (job_.checked.playable) {
    if (const control::Answer answer = server_.references_.load(job_.checked); !answer.ok) return answer;
  }
  name_ = job_.checked.playable ? job_.checked.playable->reference().name : system_.status().reference;
  result_.duration_s = server_.references_.loadedDuration();
  if (isInterrupted()) return breakOff();
  control::PathExpectation as_asked{name_, job_.wishes.halts, job_.wishes.pauses, job_.wishes.loaded};
  if (job_.checked.playable) as_asked.loaded = job_.checked.playable->number();
  const double most = fastestAllowed();
  double speed = std::min(most, goal.speed_percent > 0.0 ? goal.speed_percent : 100.0);
  if (goal.approach) {
    if (const control::Answer answer = approach(most, as_asked); !answer.ok) return answer;
    speed = std::min(speed, system_.status().speed_percent);  // slowed down by somebody meanwhile
  }
  if (const control::Answer answer = system_.setPathSpeed(speed); !answer.ok) return answer;
  if (!job_.recording.empty()) {
    if (const control::Answer answer = system_.startRecording(job_.recording); !answer.ok) return answer;
    result_.recording = job_.recording;
  }
  if (const control::Answer answer = system_.play(as_asked); !answer.ok) return answer;
  return follow("playing", true);
}

/// To the first point.
control::Answer PlayedGoal::approach(double speed_percent, control::PathExpectation& as_asked) {
  if (const control::Answer answer = system_.setPathSpeed(speed_percent); !answer.ok) return answer;
  const double speed = job_.handle.getGoal()->approach_speed;
  const control::Answer begun = system_.approach(speed > 0.0 ? speed : kApproachSpeed, as_asked);
  if (!begun.ok) return begun;
  const control::Answer arrived = follow("approaching", false);
  as_asked.pauses = system_.wishesSoFar().pauses;  // those on the way have been obeyed
  if (arrived.ok && system_.status().pause_asked)
    return {false, "somebody has paused the robot at the very end of the approach; it holds at the first point"};
  return arrived;
}

/// %: what somebody has set since the goal came, which may have waited for the drives, or for a disk.
double PlayedGoal::fastestAllowed() const {
  return system_.wishesSoFar().speeds == job_.wishes.speeds ? 100.0 : system_.status().speed_percent;
}

/// Until the path is at its end, or is ended by whatever.
control::Answer PlayedGoal::follow(const std::string& phase, bool measure) {
  control::ControlStatus status = system_.status();
  while (control::isOnPath(status.state)) {
    if (measure) {
      measureErrors();
      result_.path_time_s = status.path_time_s;
    }
    if (isInterrupted()) return breakOff();
    feedBack(phase, status);
    std::this_thread::sleep_for(kPoll);
    status = system_.status();
  }
  if (measure) result_.path_time_s = std::min(status.path_time_s, status.path_duration_s);
  const std::string where = phase + " ended " + shortNumber(status.path_time_s, 3) + " s after its begin, of " +
                            shortNumber(status.path_duration_s, 3) + " s: ";
  if (!status.fault_sentence.empty()) return {false, where + status.fault_sentence};  // in the safe stop already
  if (status.state != control::MachineState::Holding)
    return {false, where + "the robot is " + control::toString(status.state)};
  if (status.path_time_s + 0.5 * trajectory::kStreamPeriod < status.path_duration_s)
    return {false, where + "somebody else stopped it; the robot holds"};
  return {true, name_ + " was played to its end in " + shortNumber(status.path_duration_s, 4) +
                    " s of path time; the robot holds"};
}

/// Cancelled, preempted, ended: along the path to rest.
control::Answer PlayedGoal::breakOff() {
  const Interruption why = server_.interruption_;
  const std::string who = why == Interruption::Preempted   ? "preempted by a newer goal"
                          : why == Interruption::Cancelled ? "cancelled"
                                                           : "the controller's interface is ending";
  if (!control::isOnPath(system_.state())) return {false, who + "; the robot is " + control::toString(system_.state())};
  const control::Answer stopped = system_.stopPath();
  if (!stopped.ok && control::isOnPath(system_.state()))
    return {false, who + ", but the stop was refused: " + stopped.sentence};
  const ros::SteadyTime give_up = ros::SteadyTime::now() + ros::WallDuration(kLongestStop);
  while (control::isOnPath(system_.state()) && ros::SteadyTime::now() < give_up) {
    feedBack("stopping", system_.status());
    std::this_thread::sleep_for(kPoll);
  }
  const control::ControlStatus status = system_.status();
  return {false, who + ": slowed down along the path, " + shortNumber(status.path_time_s, 3) +
                     " s after its begin, of " + shortNumber(status.path_duration_s, 3) + " s; the robot is " +
                     control::toString(status.state)};
}

control::Answer PlayedGoal::endRecording(control::Answer answer) {
  if (result_.recording.empty()) return answer;
  const control::Answer closed = system_.stopRecording(job_.recording);
  if (!closed.ok) return {false, answer.sentence + "; " + closed.sentence};
  answer.sentence += "; " + closed.sentence;
  return answer;
}

void PlayedGoal::feedBack(const std::string& phase, const control::ControlStatus& status) {
  const ros::SteadyTime now = ros::SteadyTime::now();
  if ((now - fed_back_).toSec() < kFeedbackPeriod) return;
  fed_back_ = now;
  PlayFeedback feedback;
  feedback.phase = status.state == control::MachineState::Paused ? "paused" : phase;
  feedback.path_time_s = status.path_time_s;
  feedback.duration_s = status.path_duration_s;
  feedback.speed_percent = 100.0 * status.time_scale;
  const double left = std::max(0.0, status.path_duration_s - status.path_time_s);
  feedback.progress = status.progress;
  feedback.remaining_s = status.time_scale > 1e-3 ? left / status.time_scale : -1.0;
  if (const std::optional<control::TrackingRow> row = system_.snapshot()) {
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      feedback.error_m[i] = row->reference_m[i] - row->position_m[i];
  }
  job_.handle.publishFeedback(feedback);
}

void PlayedGoal::measureErrors() {
  const std::optional<control::TrackingRow> row = system_.snapshot();
  if (!row) return;
  ++samples_;
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    const double error = std::abs(row->reference_m[i] - row->position_m[i]);
    square_[i] += error * error;
    result_.largest_error_m[i] = std::max(result_.largest_error_m[i], error);
  }
}

}  // namespace knee_robot::nodes
