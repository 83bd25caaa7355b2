#include "knee_robot/rt/activity.h"

#include "knee_robot/base/errors.h"
#include "knee_robot/base/numbers.h"

namespace knee_robot::rt {

Activity::Activity(ActivityOptions options) : options_(std::move(options)) {
  if (options_.period <= 0) throw InputError("activity " + options_.name + ": its period must be positive");
}

void Activity::add(TaskContext& component, Nanoseconds component_period) {
  const Nanoseconds period = component_period == 0 ? options_.period : component_period;
  if (period < options_.period || period % options_.period != 0) {
    throw InputError("component " + component.name() + " has the period " + shortNumber(toSeconds(period)) +
                     " s, which is no whole multiple of the " + shortNumber(toSeconds(options_.period)) +
                     " s of activity " + options_.name);
  }
  component.setExecutor(this);
  components_.push_back(&component);
  entries_.push_back({&component, period / options_.period, 0, std::make_unique<ComponentStatistics>(), -1});
}

void Activity::runCycle(std::int64_t index, Nanoseconds wake, Nanoseconds epoch, bool clock_runs) noexcept {
  Cycle cycle;
  cycle.time = index * options_.period;
  cycle.wake = wake;
  if (last_wake_ >= 0) statistics_.period.add(wake - last_wake_);
  last_wake_ = wake;
  Nanoseconds begin = wake;
  for (Entry& entry : entries_) {
    if (index < entry.next_due) continue;
    entry.next_due = index + entry.divider;
    cycle.period = entry.divider * options_.period;
    entry.component->update(cycle);
    const Nanoseconds end = clock_runs ? monotonicNow() - epoch : wake;
    ComponentStatistics& statistics = *entry.statistics;
    statistics.updates.fetch_add(1, std::memory_order_relaxed);
    if (entry.last_begin >= 0) statistics.period.add(begin - entry.last_begin);
    statistics.lateness.add(begin - cycle.time);
    statistics.execution.add(end - begin);
    entry.last_begin = begin;
    begin = end;  // the next one begins where this one ended
  }
  statistics_.cycles.fetch_add(1, std::memory_order_relaxed);
}

void Activity::countOverrun(std::int64_t skipped) noexcept {
  statistics_.missed.fetch_add(static_cast<std::uint64_t>(skipped), std::memory_order_relaxed);
  statistics_.overruns.fetch_add(1, std::memory_order_relaxed);
  const std::uint64_t row = statistics_.overruns_row.fetch_add(1, std::memory_order_relaxed) + 1;
  const bool limit_reached = options_.overrun_limit > 0 && row == static_cast<std::uint64_t>(options_.overrun_limit);
  if (limit_reached && overrun_handler_) overrun_handler_();
}

}  // namespace knee_robot::rt
