#pragma once

#include <cstdint>

#include "knee_robot/hardware/can/canopen.h"
#include "knee_robot/hardware/can/cia402.h"
#include "knee_robot/hardware/can/frame_port.h"
#include "knee_robot/hardware/can/object_dictionary.h"

namespace knee_robot::simulation {

/// A simulated CiA 402 drive on the bus: network state, expedited service data, four process data objects each way,
/// heartbeat both ways, emergencies, the drive's state machine. What a drive is taken to do is that of the public
/// profiles (CiA 301, CiA 402); the answers in detail (which abort code, the quick stop's duration) are ours. Only a
/// reset of its communication allocates.
class DriveModel {
 public:
  /// `bus` must outlive this; the drive only sends through it.
  DriveModel(int node, hardware::can::ObjectDictionary dictionary, hardware::can::FramePort& bus);

  /// Power-up: boot-up message.
  void powerUp() noexcept;
  /// A frame from the bus.
  void take(const hardware::can::Frame& frame) noexcept;
  /// Time goes on: heartbeats, the quick stop's end. `now` by the bus' clock.
  void step(std::int64_t now) noexcept;

  /// The motor's side.
  void setPosition(std::int32_t counts) noexcept;
  void setInputs(std::uint8_t bits) noexcept;
  std::int16_t torque() const noexcept;   ///< per mille; 0 unless in Operation Enabled; limited by the current limit
  std::uint8_t outputs() const noexcept;  ///< digital outputs, bits 0..3
  hardware::can::DriveState state() const noexcept { return state_; }
  hardware::can::NmtState nmt() const noexcept { return nmt_; }
  int node() const noexcept { return node_; }
  hardware::can::ObjectDictionary& dictionary() noexcept { return dictionary_; }

  /// What may go wrong.
  void fail(std::uint16_t code) noexcept;                     ///< Fault, with this emergency
  void warn(std::uint16_t code) noexcept;                     ///< an emergency alone
  void setSilent(bool silent) noexcept { silent_ = silent; }  ///< cut off the bus
  void setHeartbeat(bool on) noexcept { beats_ = on; }
  void refuseObject(hardware::can::objects::Object object, std::uint32_t abort) noexcept;  ///< writes of it are aborted

 private:
  void send(const hardware::can::Frame& frame) noexcept;
  void enter(hardware::can::NmtState state) noexcept;
  void obey(const hardware::can::NmtOrder& order) noexcept;
  void resetCommunication() noexcept;
  void serve(const hardware::can::SdoRequest& request) noexcept;
  std::uint32_t write(const hardware::can::SdoRequest& request) noexcept;
  std::uint32_t checkPdoChange(const hardware::can::SdoRequest& request) const noexcept;
  void takeProcessData(const hardware::can::Frame& frame) noexcept;
  void applyProcessData(int number) noexcept;
  void sync() noexcept;
  void sendProcessData(int number) noexcept;
  void control(std::uint16_t word) noexcept;
  void setState(hardware::can::DriveState state) noexcept;
  void connectionLost() noexcept;
  void loadDefaults() noexcept { dictionary_ = defaults_; }

  const int node_;
  const hardware::can::ObjectDictionary defaults_;
  hardware::can::ObjectDictionary dictionary_;
  hardware::can::FramePort& bus_;
  hardware::can::NmtState nmt_ = hardware::can::NmtState::BootUp;
  hardware::can::DriveState state_ = hardware::can::DriveState::SwitchOnDisabled;
  std::int64_t now_ = 0;
  std::int64_t next_beat_ns_ = 0;
  std::int64_t heard_ns_ = -1;  // the controller's last heartbeat; -1: none yet, nothing is watched
  std::int64_t quick_stop_ends_ns_ = 0;
  std::uint16_t control_word_ = 0;
  std::array<hardware::can::Frame, 4> staged_{};
  std::array<bool, 4> is_staged_{};
  bool silent_ = false;
  bool beats_ = true;
  hardware::can::objects::Object refused_ = 0;
  std::uint32_t refusal_ = 0;
};

}  // namespace knee_robot::simulation
