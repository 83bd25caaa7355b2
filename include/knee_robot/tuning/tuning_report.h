#pragma once

#include <optional>
#include <string>
#include <vector>

#include "knee_robot/identification/axis_response.h"
#include "knee_robot/tuning/gain_proposal.h"

namespace knee_robot::tuning {

/// One actuator of the tuning assistant's answer.
struct TunedAxis {
  std::string name;                   ///< "leg 1"
  std::string driver;                 ///< component of the deployment, e.g. Driver1
  std::string reason;                 ///< why nothing is proposed; empty: see `proposed`
  PlantRange range;                   ///< meaningful without reason
  double highest_crossover_hz = 0.0;  ///< beyond it the recording shows nothing
  std::string range_source;           ///< where the masses come from, in words
  control::PidGains present;          ///< of the deployment
  LoopMargins present_worst;
  std::optional<control::PidGains> proposed;
  LoopMargins proposed_worst;
  double present_kick_N = 0.0, proposed_kick_N = 0.0;  ///< of one encoder count
};

/// What tune_pid found, for its page and report.json.
struct TuningResults {
  std::string recording, deployment;
  double servo_period_s = 0.001;
  MarginDemand demand;
  identification::AxisResponses responses;
  std::vector<TunedAxis> axes;
};

/// What the program prints.
std::string tuningSummary(const TuningResults& results);
/// report.json: plants, gains and margins.
std::string tuningJson(const TuningResults& results, const std::string& command_line);
/// report.json, and report.html that shows it with recorded and modelled force, sensitivity and step responses as
/// plots. gains.yaml:
/// properties for the deployment file.
void writeTuning(const TuningResults& results, const std::string& command_line, const std::string& folder);

}  // namespace knee_robot::tuning
