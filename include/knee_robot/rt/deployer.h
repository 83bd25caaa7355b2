#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "knee_robot/rt/activity.h"
#include "knee_robot/rt/stepped_activity.h"
#include "knee_robot/rt/task_context.h"

namespace knee_robot::rt {

enum class Execution {
  Threads,  ///< real time, one thread an activity
  Stepped,  ///< virtual clock, executed by Deployment::step()
};

/// Component type -> how to make one with this name.
using TypeFactory = std::map<std::string, std::function<std::unique_ptr<TaskContext>(const std::string& name)>>;

/// A set of components and activities as a deployment file describes it:
///
///     require_real_time: false            # optional: refuse to start without SCHED_FIFO, affinity, locked memory
///     activities:
///       - {name: servo, period_s: 0.001, priority: 80, cpu: 1, overrun_limit: 20}   # priority, cpu, overrun_limit
///       optional
///     components:                         # executed in this order within their activity
///       - {name: Sync, type: Sync, activity: servo, period_s: 0.01, properties: {stop_time_s: 0.3}}  # last two
///       optional
///     connections:                        # optional: what the ports' names and types do not say, such as those of a
///       component of your own
///       - {from: Sync.set_point, to: MySync.wanted}
///     start_order: [Sync, Driver1]        # every component once; stopped in reverse
///
/// An input that no line of `connections` names is connected to the one output of another component that has its name
/// and type, or, for an input `x_2`, to the output `x` of the component whose name ends in 2 (Driver2).
/// Two such outputs, or none for a required input, are refused.
///
/// Not real-time. Throws InputError (one sentence, file and line); nothing runs when anything is wrong.
class Deployment {
 public:
  /// Reads the file, makes, sets up and connects the components. Nothing is configured or started yet.
  Deployment(const std::string& path, const TypeFactory& factory, Execution execution);
  /// Stops what still runs.
  ~Deployment();
  Deployment(const Deployment&) = delete;
  Deployment& operator=(const Deployment&) = delete;

  /// Configures all, starts the activities, then the components in start_order (with threads: each between two cycles
  /// of its activity). When one refuses, everything that was started is stopped again in reverse and InputError thrown.
  void start();
  /// Stops the components in reverse order, then the activities. Harmless when nothing runs.
  void stop() noexcept;

  /// Executes the next cycle of a stepped deployment; its virtual time.
  Nanoseconds step();
  /// Leaves out the cycles of the next `duration` of a stepped deployment, as a pause of the machine does.
  void skip(Nanoseconds duration) noexcept;
  /// Virtual time of the cycle that step() will execute.
  Nanoseconds nextRelease() const noexcept;
  /// Executes all cycles before virtual time `end`: for a program or a test of your own (test/downstream).
  void stepUntil(Nanoseconds end);
  /// Time of the deployment's clock, ns since start(): virtual, or monotonic.
  Nanoseconds now() const noexcept;

  TaskContext* component(const std::string& name) const;  ///< nullptr when there is none
  const std::vector<std::unique_ptr<TaskContext>>& components() const { return components_; }
  const std::vector<std::unique_ptr<Activity>>& activities() const { return activities_; }
  Activity* activity(const std::string& name) const;  ///< nullptr when there is none
  /// The activity that executes `component`.
  Activity* activityOf(const TaskContext& component) const;
  /// Sentences about real-time privileges that were wanted and not obtained.
  const std::vector<std::string>& warnings() const { return warnings_; }
  Execution execution() const { return execution_; }
  const std::string& path() const { return path_; }

 private:
  const std::string path_;
  const Execution execution_;
  std::vector<std::unique_ptr<TaskContext>> components_;
  std::vector<std::unique_ptr<Activity>> activities_;
  std::vector<SteppedActivity*> stepped_;
  std::vector<TaskContext*> start_order_;
  std::vector<std::string> warnings_;
  Nanoseconds epoch_ = 0;
  Nanoseconds virtual_now_ = 0;

  friend class DeploymentReader;
  void startComponents();
};

}  // namespace knee_robot::rt
