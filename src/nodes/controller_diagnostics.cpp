#include "controller_diagnostics.h"

#include <algorithm>
#include <cmath>

#include "controller_messages.h"
#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"
#include "knee_robot/control/disturbance_sentences.h"

namespace knee_robot::nodes {
namespace {

using diagnostic_msgs::DiagnosticStatus;

constexpr int kPollsPerUpdate = 20;
constexpr double kPollPeriod = 0.05;  // s

unsigned char levelAbove(double value, double warn, double error) {
  if (!(value < error)) return DiagnosticStatus::ERROR;  // not a number, too
  return value < warn ? DiagnosticStatus::OK : DiagnosticStatus::WARN;
}

unsigned char levelBelow(double value, double warn, double error) {
  return levelAbove(-value, -warn, -error);
}

void read(const ros::NodeHandle& node, const std::string& name, double& value) {
  const std::string key = "diagnostics/" + name;
  if (node.hasParam(key) && !node.getParam(key, value))
    throw InputError("parameter " + node.resolveName(key) + " is not a number");
  if (!std::isfinite(value) || value < 0.0)
    throw InputError("parameter " + node.resolveName(key) + " must be a number from 0 on, not " + shortNumber(value));
}

void readPair(const ros::NodeHandle& node, const std::string& name, const std::string& unit, double& warn,
              double& error, bool large_is_bad) {
  read(node, name + "_warn" + unit, warn);
  read(node, name + "_error" + unit, error);
  if (large_is_bad ? warn > error : warn < error)
    throw InputError("parameters " + node.resolveName("diagnostics/" + name) +
                     "_warn and _error are the wrong way round: the warning comes before the error");
}

}  // namespace

DiagnosticThresholds DiagnosticThresholds::of(const ros::NodeHandle& node) {
  DiagnosticThresholds t;
  readPair(node, "tracking", "_m", t.tracking_warn_m, t.tracking_error_m, true);
  readPair(node, "lateness", "_s", t.lateness_warn_s, t.lateness_error_s, true);
  readPair(node, "execution", "", t.execution_warn, t.execution_error, true);
  readPair(node, "limit", "", t.limit_warn, t.limit_error, false);
  readPair(node, "thermal", "", t.thermal_warn, t.thermal_error, true);
  return t;
}

ControllerDiagnostics::ControllerDiagnostics(ros::NodeHandle& node, const control::ControlSystem& system,
                                             const mechanism::Robot& robot, const std::atomic<Guardian>& guardian)
    : system_(system),
      robot_(robot),
      guardian_(guardian),
      thresholds_(DiagnosticThresholds::of(node)),
      updater_(ros::NodeHandle(), node, ros::this_node::getName()) {
  updater_.setHardwareID(robot.path);
  updater_.add("machine", this, &ControllerDiagnostics::machine);
  updater_.add("tracking", this, &ControllerDiagnostics::tracking);
  updater_.add("limits", this, &ControllerDiagnostics::limits);
  updater_.add("motors", this, &ControllerDiagnostics::motors);
  updater_.add("residual", this, &ControllerDiagnostics::residual);
  updater_.add("timing", this, &ControllerDiagnostics::timing);
  updater_.add("guardian", this, &ControllerDiagnostics::guardian);
  updater_.add("recording", this, &ControllerDiagnostics::recording);
  updater_.add("real time", this, &ControllerDiagnostics::realTime);
  timingMessage(system_.deployment(), timing_before_);
  timer_ = node.createSteadyTimer(ros::WallDuration(kPollPeriod), [this](const ros::SteadyTimerEvent&) { poll(); });
}

void ControllerDiagnostics::poll() {
  const control::MachineState state = system_.state();
  const bool follows = state != control::MachineState::Disabled && state != control::MachineState::Faulted;
  if (const std::optional<control::TrackingRow> row = system_.snapshot(); row && follows) {
    for (std::size_t i = 0; i < hardware::kAxes; ++i)
      largest_error_[i] = std::max(largest_error_[i], std::abs(row->reference_m[i] - row->position_m[i]));
  }
  if (++polls_ % kPollsPerUpdate == 0) updater_.force_update();
}

void ControllerDiagnostics::machine(Status& status) {
  const control::ControlStatus now = system_.status();
  if (now.state == control::MachineState::Faulted) {
    status.summary(DiagnosticStatus::ERROR, now.fault_name + ": " + now.fault_sentence);
  } else if (!now.homed) {
    status.summary(DiagnosticStatus::WARN,
                   std::string(control::toString(now.state)) + "; not homed: nothing may move yet");
  } else {
    status.summary(DiagnosticStatus::OK, control::toString(now.state));
  }
  status.add("state", control::toString(now.state));
  status.add("reference", now.reference);
  status.add("playing", now.playing);
  status.add("progress", now.progress);
  status.add("safe stops", now.safe_stops);
}

void ControllerDiagnostics::tracking(Status& status) {
  const auto worst = std::max_element(largest_error_.begin(), largest_error_.end());
  status.summary(levelAbove(*worst, thresholds_.tracking_warn_m, thresholds_.tracking_error_m),
                 "largest error of the last second " + shortNumber(1e3 * *worst, 3) + " mm, leg " +
                     std::to_string(worst - largest_error_.begin() + 1));
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    status.add("error " + std::to_string(i + 1) + " (m)", largest_error_[i]);
  largest_error_.fill(0.0);
}

void ControllerDiagnostics::limits(Status& status) {
  const std::optional<control::TrackingRow> row = system_.snapshot();
  if (!row) return status.summary(DiagnosticStatus::ERROR, "nothing is measured");
  if (robot_.mechanism) {
    const mechanism::Lengths lengths(row->position_m.data());
    if (forward_.ok()) forward_ = mechanism::forwardKinematics(*robot_.mechanism, lengths, forward_.pose);
    if (!forward_.ok()) forward_ = mechanism::forwardKinematicsFromHome(*robot_.mechanism, lengths);
    if (!forward_.ok())
      return status.summary(DiagnosticStatus::ERROR, "no platform pose belongs to the measured lengths");
  }
  const Margins margins = marginsMessage(robot_, robot_.mechanism ? &forward_.pose : nullptr, *row);
  status.summary(levelBelow(margins.nearest_left, thresholds_.limit_warn, thresholds_.limit_error),
                 "nearest is " + margins.nearest + " with " + shortNumber(100.0 * margins.nearest_left, 3) + " % left");
  status.add("condition", margins.condition);
  status.add("condition limit", margins.condition_limit);
}

void ControllerDiagnostics::motors(Status& status) {
  const control::ControlStatus now = system_.status();
  const auto hottest = std::max_element(now.thermal.begin(), now.thermal.end());
  status.summary(
      levelAbove(*hottest, thresholds_.thermal_warn, thresholds_.thermal_error),
      "largest I2t share " + shortNumber(*hottest, 3) + ", leg " + std::to_string(hottest - now.thermal.begin() + 1));
  for (std::size_t i = 0; i < hardware::kAxes; ++i)
    status.add("I2t " + std::to_string(i + 1), now.thermal[i]);
}

void ControllerDiagnostics::residual(Status& status) {
  const std::optional<control::Disturbance> now = system_.disturbance();
  if (!now) return status.summary(DiagnosticStatus::OK, "not watched: the deployment has no DisturbanceObserver");
  const std::vector<control::Notice> notices = control::noticesOf(*now);
  unsigned char level = DiagnosticStatus::OK;
  std::string sentence;
  for (const control::Notice& notice : notices) {
    level = std::max<unsigned char>(
        level, notice.level == control::Notice::Level::Error ? DiagnosticStatus::ERROR : DiagnosticStatus::WARN);
    sentence += (sentence.empty() ? "" : "; ") + notice.sentence;
  }
  if (sentence.empty()) sentence = control::sentenceWithoutNotices(*now);
  status.summary(level, sentence);
  for (std::size_t i = 0; i < hardware::kAxes; ++i) {
    status.add("rms " + std::to_string(i + 1) + " (N)", now->rms_N[i]);
    status.add("band " + std::to_string(i + 1) + " (N)", now->band_N[i]);
  }
}

void ControllerDiagnostics::timing(Status& status) {
  const Timing timing = timingMessage(system_.deployment(), timing_before_);
  std::uint64_t missed = 0;
  unsigned char level = DiagnosticStatus::OK;
  std::string sentence;
  for (const ActivityTiming& activity : timing.activities) {
    missed += activity.missed;
    level =
        std::max(level, levelAbove(activity.lateness_p99_s, thresholds_.lateness_warn_s, thresholds_.lateness_error_s));
    level = std::max(level, levelAbove(activity.execution_p99_s / activity.period_s, thresholds_.execution_warn,
                                       thresholds_.execution_error));
    sentence += activity.name + ": 99 % late by less than " + shortNumber(1e6 * activity.lateness_p99_s, 3) +
                " us, ran for less than " + shortNumber(1e6 * activity.execution_p99_s, 3) + " us; ";
    status.add(activity.name + " cycles", activity.cycles);
    status.add(activity.name + " missed", activity.missed);
    status.add(activity.name + " largest lateness (s)", activity.lateness_max_s);
    status.add(activity.name + " largest execution (s)", activity.execution_max_s);
  }
  const std::uint64_t missed_now = missed - missed_before_;
  missed_before_ = missed;
  if (missed_now > 0) level = std::max<unsigned char>(level, DiagnosticStatus::WARN);
  status.summary(level, sentence + std::to_string(missed_now) + " left out");
}

void ControllerDiagnostics::guardian(Status& status) {
  switch (guardian_.load()) {
    case Guardian::None:
      return status.summary(DiagnosticStatus::WARN,
                            "none: when the controller dies, the drives keep what they got last");
    case Guardian::Silent:
      return status.summary(DiagnosticStatus::ERROR,
                            "silent: nothing brings the outputs down when the controller dies");
    case Guardian::Acts:
      return status.summary(DiagnosticStatus::OK, "on guard");
  }
}

void ControllerDiagnostics::recording(Status& status) {
  const control::ControlStatus now = system_.status();
  if (now.dropped_rows > 0) {
    status.summary(DiagnosticStatus::ERROR, std::to_string(now.dropped_rows) + " rows were dropped");
  } else if (!now.black_box_error.empty()) {
    status.summary(DiagnosticStatus::WARN, "black box: " + now.black_box_error);
  } else {
    status.summary(DiagnosticStatus::OK, now.recording.empty() ? "none" : "to " + now.recording);
  }
  status.add("rows", now.recorded_rows);
  status.add("cycles that the machine skipped", now.skipped_cycles);
}

void ControllerDiagnostics::realTime(Status& status) {
  const std::vector<std::string> warnings = system_.warnings();
  if (warnings.empty())
    return status.summary(DiagnosticStatus::OK, "priority, processor and locked memory as asked for");
  status.summary(DiagnosticStatus::WARN, warnings.front());
  for (std::size_t i = 0; i < warnings.size(); ++i)
    status.add("warning " + std::to_string(i + 1), warnings[i]);
}

}  // namespace knee_robot::nodes
