#pragma once

#include <array>
#include <atomic>

#include "knee_robot/control/axis_data.h"
#include "knee_robot/rt/channel.h"
#include "knee_robot/rt/operation.h"
#include "knee_robot/rt/port.h"

namespace knee_robot::control {

/// Real-time side of the recording, after AxesOutput in the servo cycle: puts together what was read, asked for and
/// written in this cycle, publishes it, and pushes it into a preallocated ring while a recording runs. RecordingDrain
/// empties the ring.
class Recorder : public rt::TaskContext {
 public:
  /// 16 s at 1 kHz.
  static constexpr std::size_t kRingRows = 16384;

  explicit Recorder(const std::string& name);

  rt::InputPort<AxesMeasurement> measurement{*this, "measurement", "from AxesInput"};
  rt::InputPort<SetPoint> set_point{*this, "set_point", "from Sync"};
  rt::InputPort<AxisCommand> command_1{*this, "command_1", "from the Driver of axis 1"};
  rt::InputPort<AxisCommand> command_2{*this, "command_2", "from the Driver of axis 2"};
  rt::InputPort<AxisCommand> command_3{*this, "command_3", "from the Driver of axis 3"};
  rt::InputPort<AxisCommand> command_4{*this, "command_4", "from the Driver of axis 4"};
  rt::InputPort<AxesWritten> written{*this, "written", "from AxesOutput"};
  rt::InputPort<Disturbance> disturbance{*this, "disturbance", "from the DisturbanceObserver: the residual",
                                         rt::Need::Optional};
  rt::OutputPort<TrackingRow> row{*this, "row", "the row of this cycle"};

  rt::Operation<void(std::uint32_t)> record{
      *this,
      "record",
      {"number"},
      "rows are pushed with this number from the next cycle on; 0: none",
      [this](std::uint32_t number) { recording_.store(number, std::memory_order_release); }};
  rt::Operation<bool(TrackingRow&)> pop{
      *this, "pop", {"row"}, "next row, for one draining thread; false: none there", [this](TrackingRow& row) {
        return ring_.read(row);
      }};
  rt::Operation<std::uint64_t()> dropped{
      *this, "dropped", {}, "rows that found the ring full since the construction", [this] {
        return dropped_.load(std::memory_order_relaxed);
      }};

 protected:
  void updateHook(const rt::Cycle& cycle) override;

 private:
  const std::array<rt::InputPort<AxisCommand>*, hardware::kAxes> inputs_;
  rt::BufferChannel<TrackingRow> ring_{kRingRows};
  std::atomic<std::uint32_t> recording_{0};
  std::atomic<std::uint64_t> dropped_{0};
  AxesMeasurement measured_;
  SetPoint set_point_;
  std::array<AxisCommand, hardware::kAxes> commands_{};
  AxesWritten written_;
  Disturbance disturbance_;
  TrackingRow out_;
  std::uint64_t recorded_ = 0;  ///< sequence of the last row
};

}  // namespace knee_robot::control
