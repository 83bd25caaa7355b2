#include "knee_robot/hardware/can/drive_node.h"

#include <algorithm>

#include "knee_robot/hardware/can/cia402_objects.h"

namespace knee_robot::hardware::can {
namespace {

constexpr int kLate = 8;     // what a period with more than one feedback adds; one with exactly one takes 1 off
constexpr int kMissing = 2;  // what a period without feedback adds to a count that one with feedback takes 1 off
constexpr int kSparse = 4;   // times the periods in a row that may be missing
constexpr int kNetworkStops = 3;
constexpr std::uint16_t kHeartbeatMissed = 0x8130;
constexpr int kTorqueBand = 150;    // per mille of the rated torque, beside every set value of the last periods
constexpr int kTorquePeriods = 10;  // in a row

}  // namespace

void DriveNode::begin(std::int64_t now) noexcept {
  const int node = node_;
  const DriveTolerances tolerances = tolerances_;
  const bool expects_inputs = expects_inputs_;
  *this = DriveNode(node, tolerances);
  expects_inputs_ = expects_inputs;
  heartbeat_ns_ = now;
  goal_since_ns_ = now;
}

bool DriveNode::takeFeedback(const Frame& frame) noexcept {
  if (frame.length != 8) {
    strange_length_ = frame.length;
    return false;
  }
  status_word_ = static_cast<std::uint16_t>(unsignedAt(frame, 0, 2));
  position_ = static_cast<std::int32_t>(unsignedAt(frame, 2, 4));
  torque_ = static_cast<std::int16_t>(unsignedAt(frame, 6, 2));
  heard_ = true;
  ++feedbacks_;
  return true;
}

bool DriveNode::take(const Frame& frame) noexcept {
  if (frame.extended || frame.remote || frame.error) return false;
  const auto node = static_cast<std::uint32_t>(node_);
  if (frame.id == kTransmitPdoBase + node) return takeFeedback(frame);
  if (frame.id == kTransmitPdoBase + 0x100 + node && frame.length == 4) {
    inputs_ = static_cast<std::uint8_t>(unsignedAt(frame, 0, 4) >> objects::kFirstLine & 0x0F);
    ++inputs_seen_;
    return true;
  }
  if (const auto beat = parseHeartbeat(frame); beat && beat->node == node_) {
    heartbeat_ns_ = std::max(heartbeat_ns_, frame.received_ns);
    nmt_ = beat->state;
    restarted_ = restarted_ || nmt_ == NmtState::BootUp;
    return true;
  }
  if (const auto emergency = parseEmergency(frame); emergency && emergency->node == node_) {
    takeEmergency(emergency->code);
    return true;
  }
  return false;
}

/// The first one is the cause, and who repeats it does not put its verdict off; "no error" takes back nothing that
/// happened.
void DriveNode::takeEmergency(std::uint16_t code) noexcept {
  if (code == 0 || (emergency_ != 0 && code != kHeartbeatMissed)) return;
  if (emergency_ == 0) emergency_cycles_ = 0;
  emergency_ = code;
}

/// Feedback of a SYNC comes within its period. What comes twice or not at all came late or out of order.
void DriveNode::endCycle() noexcept {
  if (feedbacks_ > 0) missed_ = 0;
  if (inputs_seen_ > 0) inputs_missed_ = 0;
  monitorTorque();
  if (syncs_ > 0) {
    if (feedbacks_ == 0) ++missed_;
    const int limit = 2 * kSparse * tolerances_.missed_feedback;
    sparse_ = std::clamp(sparse_ + (feedbacks_ == 0 ? kMissing : -1), 0, limit);
    if (inputs_seen_ == 0 && expects_inputs_) ++inputs_missed_;
    if (feedbacks_ > syncs_) irregular_ = std::min(irregular_ + kLate, 2 * kLate * tolerances_.missed_feedback);
    if (feedbacks_ == syncs_) irregular_ = std::max(irregular_ - 1, 0);
    syncs_ = 0;
  }
  feedbacks_ = inputs_seen_ = 0;
  emergency_cycles_ = std::min(emergency_cycles_ + 1, 2);
  if (isEnabled()) was_enabled_ = goal_ == DriveGoal::Enabled;
}

void DriveNode::torqueSent(std::int16_t torque) noexcept {
  std::rotate(sent_.rbegin(), sent_.rbegin() + 1, sent_.rend());
  sent_[0] = torque;
}

/// What the drive reports belongs to one of the last set values: it acts at SYNC and answers with the next.
void DriveNode::monitorTorque() noexcept {
  if (feedbacks_ == 0) return;
  const auto [low, high] = std::minmax_element(sent_.begin(), sent_.end());
  const bool fits = torque_ >= *low - kTorqueBand && torque_ <= *high + kTorqueBand;
  deviating_ = fits || !isEnabled() ? 0 : std::min(deviating_ + 1, kTorquePeriods);
}

void DriveNode::setGoal(DriveGoal goal, std::int64_t now) noexcept {
  if (goal == goal_) return;
  goal_ = goal;
  goal_since_ns_ = now;
  network_stops_ = 0;
  was_enabled_ = false;
}

void DriveNode::requestFaultReset() noexcept {
  emergency_ = 0;
  irregular_ = sparse_ = 0;
  if (state() == DriveState::Fault) reset_.request();
}

bool DriveNode::takeNetworkStop(std::int64_t now) noexcept {
  const bool due = staysOn(now) && now - goal_since_ns_ > (network_stops_ + 1) * tolerances_.enable_timeout_ns;
  if (!due || network_stops_ >= kNetworkStops) return false;
  ++network_stops_;
  return true;
}

std::uint16_t DriveNode::nextControlWord() noexcept {
  // A drive that dropped out by itself comes back only after it has been switched off: no jump into an old motion.
  const bool dropped_out = was_enabled_ && !isEnabled();
  const DriveGoal goal = dropped_out ? DriveGoal::Off : goal_;
  return reset_.controlWord(state(), can::controlWord(state(), goal));
}

BusFailure DriveNode::failure(std::int64_t now) const noexcept {
  if (const BusFault fault = withoutLoop(now); fault != BusFault::None) return {fault, 0, emergency_};
  // The status word that tells whether the drive went to Fault with it comes up to a period later.
  if (emergency_ != 0 && emergency_cycles_ >= 2) return {BusFault::DriveEmergency, 0, emergency_};
  if (inputs_missed_ > tolerances_.missed_feedback) return {BusFault::InputsStale, 0, 0};
  if (now - heartbeat_ns_ > tolerances_.heartbeat_timeout_ns) return {BusFault::DriveHeartbeatLost, 0, 0};
  const bool late =
      sparse_ >= kSparse * tolerances_.missed_feedback || irregular_ >= kLate * tolerances_.missed_feedback;
  return {late ? BusFault::FeedbackLate : BusFault::None, 0, 0};
}

/// What it has warned of before, or another drive, must not hide that it gives no force now.
BusFault DriveNode::withoutLoop(std::int64_t now) const noexcept {
  if (emergency_ == kHeartbeatMissed) return BusFault::ControllerHeartbeatLost;
  const bool faulted = state() == DriveState::Fault || state() == DriveState::FaultReaction;
  if (faulted && !reset_.pending()) return BusFault::DriveFault;
  if (restarted_ || (nmt_ != NmtState::Operational && nmt_ != NmtState::PreOperational)) return BusFault::DriveLost;
  if (missed_ > tolerances_.missed_feedback) return BusFault::DriveLost;
  if (nmt_ == NmtState::PreOperational && now - goal_since_ns_ > tolerances_.heartbeat_timeout_ns)
    return BusFault::DriveLost;
  if (deviating_ >= kTorquePeriods) return BusFault::TorqueDeviates;
  if (staysOn(now)) return BusFault::DriveStaysOn;
  const bool due = was_enabled_ || now - goal_since_ns_ > tolerances_.enable_timeout_ns;
  return goal_ == DriveGoal::Enabled && !isEnabled() && due ? BusFault::DriveNotEnabled : BusFault::None;
}

}  // namespace knee_robot::hardware::can
