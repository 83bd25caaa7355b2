#pragma once

#include <string>
#include <vector>

#include "knee_robot/identification/evaluation.h"
#include "knee_robot/report/recorded_units_of.h"
#include "knee_robot/tracing/next_experiment.h"
#include "knee_robot/tracing/pose_trace.h"
#include "knee_robot/tracing/trace.h"

namespace knee_robot::report {

/// Everything that trace's files say.
struct TraceResults {
  RecordedUnits units;       ///< see toRecordedUnits; plain: m and N
  std::string command_line;  ///< that reproduces this
  std::string robot_path;
  tracing::TraceOptions options;
  tracing::TraceResult result;
  dynamics::Model model;
  std::vector<identification::Observation> train;
  std::vector<identification::Observation> validate;  ///< may be empty
  identification::Applied train_before, train_after;
  identification::Applied validate_before, validate_after;  ///< empty without validation recordings
  std::vector<Eigen::VectorXd>
      validate_gain_N;           ///< per effect: fall of the validation rms when it is put in, per actuator
  tracing::PoseTrace pose;       ///< not available without camera columns
  tracing::NextExperiment next;  ///< written as next_experiment.txt when planned
};

/// Errors of a block bootstrap: 95 % interval of the rms after minus before, per actuator (both sides low-passed).
struct GainInterval {
  Eigen::VectorXd low_N, high_N;
};
GainInterval bootstrapGain(const std::vector<identification::Observation>& observations,
                           const identification::Applied& before, const identification::Applied& after, unsigned seed);

/// report.json of docs/files.md, with "absorbed", "not_added", "notes", "verdict".
std::string traceJson(const TraceResults& results);
/// What the program prints.
std::string traceSummary(const TraceResults& results);
/// One sentence on what adding effects did to the error on the held-out recordings: down or up. The first of terminal
/// and report.
std::string traceOutcome(const TraceResults& results);
/// One sentence on whether there was anything to explain.
std::string traceVerdict(const TraceResults& results);
/// model.yaml, report.json, report.html, prediction_NAME.csv (with before_i_N) of each validation recording, and
/// next_experiment.txt when there is something to separate.
void writeTraceFiles(const TraceResults& results, const std::string& folder);

}  // namespace knee_robot::report
