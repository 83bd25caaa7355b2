#include "knee_robot/rt/statistics_report.h"

#include <cstdio>

namespace knee_robot::rt {
namespace {

ComponentReport componentReport(const Activity& activity, std::size_t index) {
  const TaskContext& component = *activity.components()[index];
  const ComponentStatistics& statistics = activity.componentStatistics(index);
  ComponentReport report;
  report.name = component.name();
  report.state = component.state();
  report.period = activity.componentPeriod(index);
  report.updates = statistics.updates.load(std::memory_order_relaxed);
  report.periods = statistics.period.snapshot();
  report.lateness = statistics.lateness.snapshot();
  report.execution = statistics.execution.snapshot();
  return report;
}

std::string columns(const DurationHistogram::Snapshot& of) {
  char text[64];
  std::snprintf(text, sizeof text, " %9.1f %9.1f %9.1f", 1e-3 * static_cast<double>(of.quantile(0.5)),
                1e-3 * static_cast<double>(of.quantile(0.99)), 1e-3 * static_cast<double>(of.max));
  return text;
}

std::string line(const std::string& name, std::uint64_t count, const DurationHistogram::Snapshot& periods,
                 const DurationHistogram::Snapshot& lateness, const DurationHistogram::Snapshot& execution) {
  char head[64];
  std::snprintf(head, sizeof head, "%-16s %10llu", name.c_str(), static_cast<unsigned long long>(count));
  return head + columns(periods) + columns(lateness) + columns(execution) + "\n";
}

}  // namespace

std::vector<ActivityReport> statisticsOf(const Deployment& deployment) {
  std::vector<ActivityReport> reports;
  for (const auto& activity : deployment.activities()) {
    const ActivityStatistics& statistics = activity->statistics();
    ActivityReport report;
    report.name = activity->name();
    report.period = activity->options().period;
    report.priority = activity->options().priority;
    report.cpu = activity->options().cpu;
    report.cycles = statistics.cycles.load(std::memory_order_relaxed);
    report.missed = statistics.missed.load(std::memory_order_relaxed);
    report.overruns = statistics.overruns.load(std::memory_order_relaxed);
    report.periods = statistics.period.snapshot();
    report.lateness = statistics.lateness.snapshot();
    report.execution = statistics.execution.snapshot();
    for (std::size_t index = 0; index < activity->components().size(); ++index)
      report.components.push_back(componentReport(*activity, index));
    reports.push_back(std::move(report));
  }
  return reports;
}

std::string toText(const std::vector<ActivityReport>& reports) {
  std::string text =
      "us               executed        period: 50 %, 99 %, largest    lateness                      execution\n";
  for (const ActivityReport& report : reports) {
    text += line(report.name, report.cycles, report.periods, report.lateness, report.execution);
    for (const ComponentReport& one : report.components)
      text += line("  " + one.name, one.updates, one.periods, one.lateness, one.execution);
    text +=
        "  " + std::to_string(report.missed) + " cycles skipped on " + std::to_string(report.overruns) + " occasions\n";
  }
  return text;
}

}  // namespace knee_robot::rt
