#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "knee_robot/rt/statistics.h"
#include "knee_robot/rt/task_context.h"

namespace knee_robot::rt {

/// What an activity is: see the deployment file.
struct ActivityOptions {
  std::string name = "activity";
  Nanoseconds period = 1'000'000;  ///< ns
  int priority = 0;                ///< SCHED_FIFO 1 to 99; 0: ordinary scheduling
  int cpu = -1;                    ///< bound to this processor; -1: any
  bool require_real_time = false;  ///< refuse to start without SCHED_FIFO, affinity and locked memory
  int overrun_limit = 20;          ///< overruns in a row that call the handler; 0: never
};

/// Executes components in the order in which they were added, once a period. A component's own period is a whole
/// multiple.
class Activity : public Executor {
 public:
  explicit Activity(ActivityOptions options);

  const std::string& name() const { return options_.name; }
  const ActivityOptions& options() const { return options_; }
  const ActivityStatistics& statistics() const { return statistics_; }
  const std::vector<TaskContext*>& components() const { return components_; }
  /// Of the component at this place of components(). Readable from any thread at any time.
  const ComponentStatistics& componentStatistics(std::size_t index) const { return *entries_[index].statistics; }
  Nanoseconds componentPeriod(std::size_t index) const { return entries_[index].divider * options_.period; }

  /// Before start(). `component_period` 0 stands for the activity's. Throws InputError when it is no whole multiple.
  void add(TaskContext& component, Nanoseconds component_period = 0);
  /// The processor in place of the options'; -1: any. Before start().
  void bindTo(int cpu) { options_.cpu = cpu; }
  /// Called from the activity's thread, once, when `overrun_limit` overruns happened in a row. Real-time code only.
  /// Before start().
  void setOverrunHandler(std::function<void()> handler) { overrun_handler_ = std::move(handler); }

  /// `epoch`: zero of the deployment's clock on CLOCK_MONOTONIC, ns. Throws InputError when real time is required but
  /// not to be had. Answers what was wanted but not obtained, in sentences (empty: everything).
  virtual std::vector<std::string> start(Nanoseconds epoch) = 0;
  /// Waits for the running cycle to end. Components are not stopped.
  virtual void stop() = 0;
  virtual bool isActive() const noexcept = 0;

 protected:
  /// Runs the components that are due in cycle `index` (planned at index * period). Times are
  /// measured on CLOCK_MONOTONIC against `epoch`; without `clock_runs` the clock is virtual and all durations are zero.
  void runCycle(std::int64_t index, Nanoseconds wake, Nanoseconds epoch, bool clock_runs) noexcept;
  void countOverrun(std::int64_t skipped) noexcept;
  void countPunctual() noexcept { statistics_.overruns_row.store(0, std::memory_order_relaxed); }

  ActivityOptions options_;
  ActivityStatistics statistics_;

 private:
  struct Entry {
    TaskContext* component;
    std::int64_t divider;   // component's period in periods of the activity
    std::int64_t next_due;  // cycle index
    std::unique_ptr<ComponentStatistics> statistics;
    Nanoseconds last_begin;  // since the epoch; negative: never
  };
  std::vector<Entry> entries_;
  std::vector<TaskContext*> components_;
  std::function<void()> overrun_handler_;
  Nanoseconds last_wake_ = -1;
};

/// One thread on clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME). Cycles lie at epoch + k * period. Missed cycles are
/// skipped, counted and reported, never caught up: a component that is due after a pause runs once and keeps its
/// spacing from there.
class PeriodicActivity final : public Activity {
 public:
  explicit PeriodicActivity(ActivityOptions options);
  ~PeriodicActivity() override;

  std::vector<std::string> start(Nanoseconds epoch) override;
  void stop() override;
  bool isActive() const noexcept override { return active_.load(std::memory_order_acquire); }
  bool mustHandOver() const noexcept override;

 private:
  std::vector<std::string> acquirePrivileges() const;
  void run(Nanoseconds epoch) noexcept;

  std::thread thread_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> active_{false};
};

}  // namespace knee_robot::rt
