#pragma once

#include <string>
#include <vector>

#include "knee_robot/rt/deployer.h"
#include "knee_robot/rt/statistics.h"

namespace knee_robot::rt {

/// Timing of one component since the start, as plain data.
struct ComponentReport {
  std::string name;
  TaskState state = TaskState::PreOperational;
  Nanoseconds period = 0;  ///< planned, ns
  std::uint64_t updates = 0;
  DurationHistogram::Snapshot periods, lateness, execution;  ///< ns; see ComponentStatistics
};

/// Timing of one activity and of its components, in the order in which they are executed.
struct ActivityReport {
  std::string name;
  Nanoseconds period = 0;  ///< planned, ns
  int priority = 0;        ///< asked for; what was not obtained is in Deployment::warnings()
  int cpu = -1;
  std::uint64_t cycles = 0;
  std::uint64_t missed = 0;    ///< cycles skipped
  std::uint64_t overruns = 0;  ///< occasions on which cycles were skipped
  DurationHistogram::Snapshot periods, lateness, execution;
  std::vector<ComponentReport> components;
};

/// Not real-time; any thread, at any time. Figures read together may be one cycle apart.
std::vector<ActivityReport> statisticsOf(const Deployment& deployment);

/// The same as a table for a log: one line an activity and one a component; median, 99 %, largest in microseconds.
std::string toText(const std::vector<ActivityReport>& reports);

}  // namespace knee_robot::rt
