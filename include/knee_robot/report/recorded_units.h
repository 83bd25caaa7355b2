#pragma once

#include <string>
#include <vector>

#include "knee_robot/mechanism/robot.h"
#include "knee_robot/report/identify_report.h"
#include "knee_robot/report/predict_report.h"
#include "knee_robot/report/trace_report.h"

namespace knee_robot::report {

/// A chain's results in the units that its recorder wrote (N m, A, rad) instead of metres and newtons at
/// mechanism::kJointRadius_m; the results of other robots are left as they are. Afterwards `units` of the results label
/// them. Not to be called twice.
void toRecordedUnits(const mechanism::Robot& robot, IdentifyResults& results);
void toRecordedUnits(const mechanism::Robot& robot, TraceResults& results);
void toRecordedUnits(const mechanism::Robot& robot, PredictResults& results);

/// Text with the labels of these units: written for m and N, read for what they are.
std::string withUnits(const RecordedUnits& units, std::string text);
/// report.json with keys that end in the units' names, rms_N becomes rms_Nm, rms_A, or rms where joints differ (then
/// "units" says which), and with sentences in these units.
std::string jsonWithUnits(const RecordedUnits& units, const std::string& json);

}  // namespace knee_robot::report
