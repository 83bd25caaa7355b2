#pragma once

#include <array>
#include <cstdint>

#include "knee_robot/hardware/bus_failure.h"
#include "knee_robot/hardware/can/canopen.h"
#include "knee_robot/hardware/can/cia402.h"

namespace knee_robot::hardware::can {

/// Limits of what is tolerated of a drive.
struct DriveTolerances {
  int missed_feedback = 3;  ///< periods in a row
  std::int64_t heartbeat_timeout_ns = 50'000'000;
  std::int64_t enable_timeout_ns = 100'000'000;  ///< until Operation Enabled
};

/// What the controller knows of one drive while it runs, and what it concludes from that. Real-time safe.
class DriveNode {
 public:
  DriveNode() = default;
  DriveNode(int node, const DriveTolerances& tolerances) : node_(node), tolerances_(tolerances) {}

  /// Takes the frame when it is this drive's feedback, heartbeat or emergency.
  bool take(const Frame& frame) noexcept;
  /// A SYNC goes out: from now on one feedback is expected.
  void syncSent() noexcept { ++syncs_; }
  /// Once a cycle, after all received frames have been taken.
  void endCycle() noexcept;
  /// This drive reads the machine's safety inputs: they have to come with every SYNC.
  void expectInputs() noexcept { expects_inputs_ = true; }
  /// Per mille that goes out now; 0 until the drive is enabled.
  void torqueSent(std::int16_t torque) noexcept;
  /// Starts to expect what a running drive does.
  void begin(std::int64_t now) noexcept;

  void setGoal(DriveGoal goal, std::int64_t now) noexcept;
  void requestFaultReset() noexcept;
  /// Control word for the next cycle.
  std::uint16_t nextControlWord() noexcept;

  /// None, or the most telling of what is wrong, first of all what breaks the loop; axis is left 0.
  BusFailure failure(std::int64_t now) const noexcept;
  bool hasFeedback() const noexcept { return heard_; }
  /// Feedback since the last cycle; more than one a SYNC comes from somebody else.
  int feedbacks() const noexcept { return feedbacks_; }
  /// Bytes of the last feedback that was refused for its length; 0: none was.
  int strangeLength() const noexcept { return strange_length_; }
  /// It has been off for longer than switching off takes, by its orders, and was on by its last word.
  bool staysOn(std::int64_t now) const noexcept {
    return goal_ == DriveGoal::Off && isEnabled() && now - goal_since_ns_ > tolerances_.enable_timeout_ns;
  }
  /// True a few times, apart, while it stays on: what process data cannot do the network's stop may.
  bool takeNetworkStop(std::int64_t now) noexcept;
  /// Two periods or more without feedback: position and torque are old.
  bool isSilent() const noexcept { return missed_ >= 2; }
  bool isEnabled() const noexcept { return heard_ && state() == DriveState::OperationEnabled; }
  DriveState state() const noexcept { return stateOf(status_word_); }
  std::int32_t position() const noexcept { return position_; }  ///< counts
  std::int16_t torque() const noexcept { return torque_; }      ///< per mille
  std::uint8_t inputs() const noexcept { return inputs_; }      ///< bits 0..3
  int node() const noexcept { return node_; }

 private:
  bool takeFeedback(const Frame& frame) noexcept;
  void takeEmergency(std::uint16_t code) noexcept;
  void monitorTorque() noexcept;
  BusFault withoutLoop(std::int64_t now) const noexcept;

  int node_ = 0;
  DriveTolerances tolerances_;
  bool heard_ = false;
  std::uint16_t status_word_ = 0;
  std::int32_t position_ = 0;
  std::int16_t torque_ = 0;
  std::uint8_t inputs_ = 0;
  int syncs_ = 0;      // since the last endCycle
  int feedbacks_ = 0;  // since the last endCycle
  int missed_ = 0;     // periods in a row
  int sparse_ = 0;     // leaky count of periods without feedback
  int strange_length_ = 0;
  bool expects_inputs_ = false;
  int inputs_seen_ = 0;                 // since the last endCycle
  int inputs_missed_ = 0;               // periods in a row
  std::array<std::int16_t, 4> sent_{};  // the newest first
  int deviating_ = 0;                   // periods in a row
  int irregular_ = 0;                   // leaky count of periods with more than one feedback
  std::int64_t heartbeat_ns_ = 0;
  NmtState nmt_ = NmtState::Operational;
  bool restarted_ =
      false;  // since begin(): its configuration and its count are gone, even when it runs again by itself
  std::uint16_t emergency_ = 0;
  int emergency_cycles_ = 0;  // since it came, up to 2
  DriveGoal goal_ = DriveGoal::Off;
  std::int64_t goal_since_ns_ = 0;
  int network_stops_ = 0;  // since the goal changed
  bool was_enabled_ = false;
  FaultReset reset_;
};

}  // namespace knee_robot::hardware::can
