#pragma once

#include <string>
#include <vector>

namespace knee_robot::report {

/// What a program that writes a report looks at before its work.
struct ReportPlan {
  std::string command;                 ///< identify, trace, predict, compare, drive_gains or tune_pid
  std::string folder;                  ///< --output
  std::vector<std::string> read;       ///< files that it is given; empty names are none
  std::vector<std::string> predicted;  ///< recordings that it writes predictions of
};

/// InputError when the folder takes no files, or when a file that is read would be overwritten there, or removed
/// because an earlier run of the command left it. Nothing is made.
void requireReportFolder(const ReportPlan& plan);

}  // namespace knee_robot::report
