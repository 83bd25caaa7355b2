#pragma once

#include <mutex>
#include <optional>

#include "knee_robot/control/machine_state.h"
#include "machine_components.h"
#include "request_numbers.h"

namespace knee_robot::control {

/// The operator's end of the real-time ports: a component that no activity executes. Any thread may call; the real-time
/// side waits for none of them.
class OperatorPanel : public rt::TaskContext {
 public:
  /// Connects itself.
  explicit OperatorPanel(const MachineComponents& machine);

  /// Number under which the Supervisor will answer, until forget(number); empty: too many requests wait.
  /// After the time `expires` the Supervisor refuses it.
  std::optional<std::uint32_t> send(RequestKind kind, double value, rt::Nanoseconds expires);
  void forget(std::uint32_t number);
  /// The newest of each; before the first cycle there is none, and the Supervisor's is the default.
  SupervisorStatus supervisor() const;
  std::optional<TrackingRow> row() const;
  std::optional<MonitorVerdict> verdict() const;
  std::optional<AxesWritten> written() const;
  std::optional<Disturbance> disturbance() const;

 private:
  template <typename T>
  std::optional<T> newest(rt::InputPort<T>& port) const;

  rt::OutputPort<Request> request_{*this, "request", "to the Supervisor"};
  mutable rt::InputPort<SupervisorStatus> status_{*this, "status", "from the Supervisor"};
  mutable rt::InputPort<TrackingRow> row_{*this, "row", "from the Recorder"};
  mutable rt::InputPort<MonitorVerdict> verdict_{*this, "verdict", "from Monitors"};
  mutable rt::InputPort<AxesWritten> written_{*this, "written", "from AxesOutput"};
  mutable rt::InputPort<Disturbance> disturbance_{*this, "disturbance", "from the DisturbanceObserver",
                                                  rt::Need::Optional};
  mutable std::mutex mutex_;  // a port has one reader
  RequestNumbers numbers_;
};

}  // namespace knee_robot::control
