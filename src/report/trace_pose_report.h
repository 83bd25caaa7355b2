#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "knee_robot/tracing/pose_trace.h"

namespace knee_robot::report {

/// "pose" of report.json: before and after (rms_m of X and Z, rms_rad of theta and psi; on validation recordings when
/// there are any, else on training), per recording, findings. Null without a camera.
nlohmann::ordered_json tracePoseJson(const tracing::PoseTrace& pose);
/// Lines for the terminal; empty without a camera.
std::string tracePoseSummary(const tracing::PoseTrace& pose);

}  // namespace knee_robot::report
