#pragma once

#include <array>
#include <atomic>
#include <vector>

#include "knee_robot/control/axis_data.h"
#include "knee_robot/control/machine_state.h"
#include "knee_robot/rt/operation.h"
#include "knee_robot/rt/port.h"
#include "knee_robot/rt/property.h"

namespace knee_robot::control {

/// All signals of one servo cycle.
struct BlackBoxRow {
  double time_s = 0.0;      ///< when the position was read
  double lateness_s = 0.0;  ///< of the cycle
  std::int64_t cycle = 0;   ///< planned time in servo periods; a gap is a cycle that the machine skipped
  AxisValues reference_m{}, position_m{}, velocity_m_per_s{}, command_V{}, force_N{};
  AxisValues asked_V{};        ///< by the Drivers, before AxesOutput's clamp and quantization
  AxisValues feedforward_N{};  ///< the part of what they asked for that a model foresaw
  AxisValues heat{};
  std::array<std::int64_t, hardware::kAxes> counts{};
  std::array<Fault, hardware::kAxes> axis_fault{};  ///< of the Drivers and Monitors
  double path_time_s = 0.0, time_scale = 0.0;
  std::uint64_t set_point = 0;  ///< sequence number
  MachineState state = MachineState::Disabled;
  Fault fault = Fault::None;
  SyncPhase phase = SyncPhase::Idle;
  DriveLevel level = DriveLevel::Off;
  SafeStopPhase safe_stop = SafeStopPhase::Idle;
  hardware::IoStatus read_status = hardware::IoStatus::NotReady, write_status = hardware::IoStatus::NotReady;
  std::uint8_t digital_inputs = 0, digital_outputs = 0;
};

/// What is there to be written after a fault.
struct BlackBoxDump {
  Fault fault = Fault::None;
  int axis = 0;
  double fault_time_s = 0.0;      ///< on the scale of time_s
  std::vector<BlackBoxRow> rows;  ///< a ring; the oldest is at `next` once it is full
  std::size_t next = 0, count = 0;

  /// Row k of `count`, the oldest first.
  const BlackBoxRow& row(std::size_t k) const { return rows[(next + rows.size() - count + k) % rows.size()]; }
};

/// Last in the servo cycle: keeps every cycle's signals in a preallocated ring. When the Supervisor latches a fault, it
/// goes on for `rows_after`, then leaves the ring to BlackBoxWriter and goes on in a second one. A fault that comes
/// while both are waiting to be written is counted as lost; the real-time side never waits.
class BlackBox : public rt::TaskContext {
 public:
  explicit BlackBox(const std::string& name);

  rt::InputPort<AxesMeasurement> measurement{*this, "measurement", "from AxesInput"};
  rt::InputPort<SetPoint> set_point{*this, "set_point", "from Sync"};
  rt::InputPort<AxisCommand> command_1{*this, "command_1", "from the Driver of axis 1"};
  rt::InputPort<AxisCommand> command_2{*this, "command_2", "from the Driver of axis 2"};
  rt::InputPort<AxisCommand> command_3{*this, "command_3", "from the Driver of axis 3"};
  rt::InputPort<AxisCommand> command_4{*this, "command_4", "from the Driver of axis 4"};
  rt::InputPort<MonitorVerdict> verdict{*this, "verdict", "from Monitors"};
  rt::InputPort<AxesWritten> written{*this, "written", "from AxesOutput"};
  rt::InputPort<SupervisorStatus> status{*this, "status", "from the Supervisor"};

  rt::Property<int> rows{
      *this, "rows", 5500, "cycles", 10, 1000000, "cycles kept: 5 s before the fault and 0.5 s after it, at 1 kHz"};
  rt::Property<int> rows_after{*this, "rows_after", 500, "cycles", 0, 1000000, "cycles kept after the fault"};

  rt::Operation<const BlackBoxDump*()> waiting{
      *this,
      "waiting",
      {},
      "a ring that waits to be written, or null; untouched until release(); one thread at a time",
      [this] { return findWaiting(); }};
  rt::Operation<void(const BlackBoxDump*)> release{
      *this, "release", {"written"}, "gives a ring back that has been written", [this](const BlackBoxDump* written) {
        giveBack(written);
      }};
  rt::Operation<std::uint64_t()> lost{
      *this, "lost", {}, "faults whose ring could not be kept, as both were waiting", [this] {
        return lost_.load(std::memory_order_relaxed);
      }};

 protected:
  bool configureHook() override;
  void updateHook(const rt::Cycle& cycle) override;
  void stopHook() override;

 private:
  struct Slot {
    BlackBoxDump dump;
    std::atomic<bool> waits{false};  // release: the dump is complete; acquire by the writer, and the other way round
  };
  const BlackBoxDump* findWaiting() const noexcept;
  void giveBack(const BlackBoxDump* written) noexcept;
  void fill(BlackBoxRow& row, const rt::Cycle& cycle);
  void watchFault() noexcept;
  void handOver() noexcept;

  const std::array<rt::InputPort<AxisCommand>*, hardware::kAxes> inputs_;
  std::array<Slot, 2> slots_;
  std::size_t active_ = 0;
  std::atomic<std::uint64_t> lost_{0};
  bool triggered_ = false;
  int left_ = 0;  // rows until the ring is handed over
  AxesMeasurement measured_;
  SetPoint set_point_;
  std::array<AxisCommand, hardware::kAxes> commands_{};
  MonitorVerdict verdict_;
  AxesWritten written_;
  SupervisorStatus status_;
  Fault last_fault_ = Fault::None;
};

}  // namespace knee_robot::control
