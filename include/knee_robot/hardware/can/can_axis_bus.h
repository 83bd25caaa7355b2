#pragma once

#include <atomic>
#include <memory>

#include "knee_robot/hardware/axis_bus.h"
#include "knee_robot/hardware/can/can_settings.h"
#include "knee_robot/hardware/can/can_socket.h"
#include "knee_robot/hardware/can/drive_node.h"
#include "knee_robot/hardware/can/frame_port.h"
#include "knee_robot/hardware/emergency_outputs.h"

namespace knee_robot::hardware::can {

/// Four CiA 402 drives in cyclic synchronous torque on one CAN bus, as an AxisBus.
///
/// writeVolts sends each drive its control word and torque and then SYNC, at which all of them act and sample together;
/// read takes what they sampled then, so feedback is one period old (a constant delay of further whole periods could
/// not be told from it: the drives number nothing). writeOutputs sets the digital outputs of every drive (60FE, lines
/// from bit 16 on); the bit that enables drives also runs their state machines to Operation Enabled. Until a drive is
/// there its torque is 0, and `written` says so. Digital inputs are the first drive's.
///
/// Counts are zero at the self test. The drives hold nothing when the controller falls silent: they miss its heartbeat
/// and stop by themselves (6007 = 3).
class CanAxisBus : public AxisBus {
 public:
  using Units = std::array<AxisUnits, kAxes>;

  /// `process` carries PDOs, SYNC, heartbeats and emergencies in the servo thread, `service` NMT and SDO in the self
  /// test. Both on the same bus; they must outlive this. The rated torques of `units` are replaced by those of
  /// `settings`. Throws InputError when the traffic does not fit on the bus.
  CanAxisBus(FramePort& process, FramePort& service, const CanSettings& settings, const Units& units);

  SelfTest selfTest() override;
  IoStatus read(AxisFeedback& feedback) noexcept override;
  IoStatus writeVolts(const std::array<double, kAxes>& volts, std::array<double, kAxes>& written) noexcept override;
  IoStatus writeOutputs(std::uint8_t bits) noexcept override;
  BusFailure failure() const noexcept override { return failure_; }
  bool stopsByItself() const noexcept override { return true; }
  void acknowledgeFaults() noexcept override { reset_wanted_.store(true); }

  const DriveNode& drive(std::size_t axis) const { return drives_.at(axis); }

 private:
  bool awaitFeedback(std::vector<std::string>& findings);
  bool answerOnce(std::vector<std::string>& findings);
  int drain() noexcept;
  BusFailure worstOfDrives(std::int64_t now) const noexcept;
  void detectFailure(bool backlog) noexcept;
  PortStatus sendCommand(std::size_t axis, std::int16_t torque) noexcept;
  PortStatus sendHeartbeatWhenDue() noexcept;
  IoStatus statusOf(PortStatus status) noexcept;

  FramePort& process_;
  FramePort& service_;
  const CanSettings settings_;
  Units units_;
  std::array<int, kAxes> torque_limits_{};
  std::array<DriveNode, kAxes> drives_;
  std::array<std::int32_t, kAxes> zero_counts_{};
  std::int64_t next_heartbeat_ns_ = 0;
  std::int64_t troubled_ns_ = 0;  // the whole bus, not one drive, for the last time
  bool ready_ = false;
  bool down_ = false;
  bool bus_off_ = false;
  bool no_room_ = false;
  BusFailure failure_;
  std::atomic<bool> reset_wanted_{false};
};

/// The process port's filters: what the four drives send while they run.
std::vector<Filter> processFilters(const CanSettings& settings);
/// The service port's: answers and boot-up messages.
std::vector<Filter> serviceFilters(const CanSettings& settings);

/// The real bus or a simulated one: opens settings.interface twice. Throws InputError. The self test has not been run
/// yet.
std::unique_ptr<AxisBus> openCanDrives(const CanSettings& settings, const CanAxisBus::Units& units);

/// A guardian's own handle: quick stop with torque 0 to all drives, SYNC, digital outputs 0. Real-time safe.
std::unique_ptr<EmergencyOutputs> openCanEmergencyOutputs(const CanSettings& settings);

}  // namespace knee_robot::hardware::can
