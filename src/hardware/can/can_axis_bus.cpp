#include "knee_robot/hardware/can/can_axis_bus.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bus_errors.h"
#include "drive_setup.h"
#include "knee_robot/hardware/can/can_socket.h"

namespace knee_robot::hardware::can {
namespace {

constexpr int kMostFrames = 64;  // a cycle brings about a dozen: bounded time for a flooded bus
constexpr std::int64_t kFeedbackPatience_ns = 300'000'000;
constexpr std::int64_t kAnswerTime_ns = 5'000'000;  // to a SYNC, while nothing else is on the bus
constexpr int kTwinSyncs = 6;                       // each drive answers once; two with one number twice

std::int64_t nanoseconds(double seconds) {
  return std::llround(seconds * 1e9);
}

Frame commandFrame(int node, std::uint16_t control_word, std::int16_t torque) noexcept {
  Frame frame;
  frame.id = kReceivePdoBase + static_cast<std::uint32_t>(node);
  frame.length = 4;
  putUnsigned(frame, 0, 2, control_word);
  putUnsigned(frame, 2, 2, static_cast<std::uint16_t>(torque));
  return frame;
}

Frame outputsFrame(int node, std::uint8_t bits) noexcept {
  Frame frame;
  frame.id = kReceivePdoBase + 0x100 + static_cast<std::uint32_t>(node);
  frame.length = 4;
  putUnsigned(frame, 0, 4, static_cast<std::uint32_t>(bits) << objects::kFirstLine);
  return frame;
}

}  // namespace

CanAxisBus::CanAxisBus(FramePort& process, FramePort& service, const CanSettings& settings, const Units& units)
    : process_(process), service_(service), settings_(settings), units_(units) {
  requireFits(settings, "CAN " + settings.interface + ": ");
  DriveTolerances tolerances;
  tolerances.missed_feedback = settings.missed_feedback;
  tolerances.heartbeat_timeout_ns = nanoseconds(2.5 * settings.heartbeat_s);
  tolerances.enable_timeout_ns = nanoseconds(settings.enable_delay_s);
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    units_[i].rated_torque_Nm = settings.drives[i].rated_torque_Nm;
    torque_limits_[i] = torqueLimitPerMille(settings.drives[i]);
    drives_[i] = DriveNode(settings.drives[i].node, tolerances);
  }
}

SelfTest CanAxisBus::selfTest() {
  SelfTest result;
  ready_ = false;
  down_ = bus_off_ = no_room_ = false;
  failure_ = {};
  // Every drive is brought down even when another one fails. The last finding says why it stopped: the first failure.
  std::vector<std::string> failures;
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    std::vector<std::string> own;
    const bool good = setUpDrive(service_, settings_, i, own);
    std::vector<std::string>& list = good ? result.findings : failures;
    list.insert(list.end(), own.begin(), own.end());
  }
  result.findings.insert(result.findings.end(), failures.rbegin(), failures.rend());
  result.passed = failures.empty() && awaitFeedback(result.findings);
  ready_ = result.passed;
  return result;
}

/// The drives run: one SYNC, and each has to answer it.
bool CanAxisBus::awaitFeedback(std::vector<std::string>& findings) {
  const std::int64_t patience = process_.now() + kFeedbackPatience_ns;
  while (drain() == kMostFrames && process_.now() < patience) {
  }  // what came before the test
  const std::int64_t begin = process_.now();
  for (DriveNode& drive : drives_)
    drive.begin(begin);
  const std::int64_t end = begin + kFeedbackPatience_ns;
  const auto silent = [](const DriveNode& drive) { return !drive.hasFeedback(); };
  std::int64_t next_sync = begin;
  while (std::any_of(drives_.begin(), drives_.end(), silent) && process_.now() < end) {
    if (process_.now() >= next_sync) {
      process_.send(syncFrame());
      next_sync += 20'000'000;
    }
    drain();
    process_.pause(500'000);
  }
  const std::int64_t now = process_.now();
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const std::string name = "axis " + std::to_string(i + 1) + ": node " + std::to_string(drives_[i].node());
    if (!drives_[i].hasFeedback()) {
      const int bytes = drives_[i].strangeLength();
      const std::string strange = ": its feedback has " + std::to_string(bytes) + " bytes instead of 8.";
      findings.push_back(name + (bytes != 0 ? strange : ": no feedback after SYNC."));
      return false;
    }
    if (drives_[i].isEnabled()) {
      findings.push_back(name + ": is enabled although it must be off.");
      return false;
    }
    zero_counts_[i] = drives_[i].position();
    if (i == 0) drives_[i].expectInputs();
    drives_[i].begin(now);
  }
  if (!answerOnce(findings)) return false;
  // Once more, for a status word and positions that the next read finds.
  next_heartbeat_ns_ = now;
  for (DriveNode& drive : drives_)
    drive.syncSent();
  if (process_.send(syncFrame()) != PortStatus::Ok) {
    findings.push_back("CAN " + settings_.interface + ": the bus takes no frame.");
    return false;
  }
  process_.pause(2'000'000);
  char text[120];
  std::snprintf(text, sizeof text, "CAN %s: %.0f %% of %.0f kbit/s at worst.", settings_.interface.c_str(),
                100.0 * busLoad(settings_), settings_.bit_rate / 1000.0);
  findings.emplace_back(text);
  return true;
}

/// Two drives with one node number would be taken for one whose counts jump; a second controller sends a SYNC of its
/// own.
bool CanAxisBus::answerOnce(std::vector<std::string>& findings) {
  process_.pause(kAnswerTime_ns);
  drain();  // answers to earlier ones
  const std::int64_t now = process_.now();
  for (DriveNode& drive : drives_)
    drive.begin(now);
  for (int i = 0; i < kTwinSyncs; ++i) {
    process_.send(syncFrame());
    process_.pause(kAnswerTime_ns);
    drain();
  }
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const int answers = drives_[i].feedbacks();
    drives_[i].begin(process_.now());
    if (2 * answers <= 3 * kTwinSyncs) continue;
    findings.push_back("axis " + std::to_string(i + 1) + ": node " + std::to_string(drives_[i].node()) + ": " +
                       std::to_string(answers) + " answers to " + std::to_string(kTwinSyncs) +
                       " SYNC frames: two drives have this node number, or a second controller is on the bus.");
    return false;
  }
  return true;
}

/// Takes what has been received, at most kMostFrames; answers how many.
int CanAxisBus::drain() noexcept {
  Frame frame;
  for (int count = 0; count < kMostFrames; ++count) {
    const PortStatus status = process_.receive(frame);
    if (status == PortStatus::Down) {
      down_ = true;
      return count;
    }
    if (status == PortStatus::Empty) return count;
    if (status != PortStatus::Ok) continue;
    down_ = false;
    if (frame.error) {
      const BusErrors errors = busErrors(frame);
      if (errors.bus_off) bus_off_ = true;
      if (errors.restarted) bus_off_ = false;
      continue;
    }
    for (DriveNode& drive : drives_) {
      if (!drive.take(frame)) continue;
      bus_off_ = false;  // who receives is on the bus
      break;
    }
  }
  return kMostFrames;
}

/// Of all drives: one that gives no force comes before one that only warns.
BusFailure CanAxisBus::worstOfDrives(std::int64_t now) const noexcept {
  BusFailure worst;
  for (std::size_t i = 0; i < drives_.size() && !breaksTheLoop(worst.fault); ++i) {
    const BusFailure found = drives_[i].failure(now);
    if (found.fault == BusFault::None || (worst.fault != BusFault::None && !breaksTheLoop(found.fault))) continue;
    worst = found;
    worst.axis = static_cast<std::uint8_t>(i + 1);
  }
  return worst;
}

void CanAxisBus::detectFailure(bool backlog) noexcept {
  const std::int64_t now = process_.now();
  const bool flooded = backlog || no_room_;
  no_room_ = false;
  if (down_ || bus_off_ || flooded) troubled_ns_ = now;
  failure_ = {};
  if (down_) {
    failure_.fault = BusFault::InterfaceDown;
  } else if (bus_off_) {
    failure_.fault = BusFault::BusOff;
  } else {
    failure_ = worstOfDrives(now);
    if (flooded && !breaksTheLoop(failure_.fault)) failure_ = {BusFault::Flooded, 0, 0, 0};
  }
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    if (drives_[i].isSilent()) failure_.silent |= static_cast<std::uint8_t>(1u << i);
  }
}

IoStatus CanAxisBus::read(AxisFeedback& feedback) noexcept {
  if (!ready_) return down_ ? IoStatus::Disconnected : IoStatus::NotReady;
  const bool backlog = drain() == kMostFrames;
  for (DriveNode& drive : drives_)
    drive.endCycle();
  detectFailure(backlog);
  // Where only some drives are lost, the counts of the others keep their loops; `silent` says whose are old.
  const bool all_silent = failure_.silent == (1u << drives_.size()) - 1u;
  const bool lost = failure_.fault == BusFault::InterfaceDown || failure_.fault == BusFault::BusOff ||
                    (failure_.fault == BusFault::DriveLost && all_silent);
  if (lost) return IoStatus::Disconnected;
  if (backlog) return IoStatus::DeviceError;  // what has been read is old: nobody may close a loop over it
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    if (!drives_[i].hasFeedback()) {  // before the first one the position is the one of the self test
      feedback.counts[i] = 0;
      continue;
    }
    feedback.counts[i] = countDifference(drives_[i].position(), zero_counts_[i]);
  }
  feedback.digital_inputs = drives_[0].inputs();
  return IoStatus::Ok;
}

PortStatus CanAxisBus::sendCommand(std::size_t axis, std::int16_t torque) noexcept {
  return process_.send(commandFrame(drives_[axis].node(), drives_[axis].nextControlWord(), torque));
}

PortStatus CanAxisBus::sendHeartbeatWhenDue() noexcept {
  const std::int64_t now = process_.now();
  if (now < next_heartbeat_ns_) return PortStatus::Ok;
  next_heartbeat_ns_ = now + nanoseconds(settings_.heartbeat_s);
  return process_.send(heartbeatFrame(settings_.controller_node, NmtState::Operational));
}

IoStatus CanAxisBus::statusOf(PortStatus status) noexcept {
  down_ = status == PortStatus::Down;
  if (status == PortStatus::Ok) return IoStatus::Ok;
  no_room_ = no_room_ || status == PortStatus::Full;
  return down_ ? IoStatus::Disconnected : IoStatus::DeviceError;
}

/// A drive that cannot be reached does not keep the others from their commands: they have to hold the platform.
IoStatus CanAxisBus::writeVolts(const std::array<double, kAxes>& volts, std::array<double, kAxes>& written) noexcept {
  if (!ready_) return IoStatus::NotReady;
  for (const double value : volts)
    if (!std::isfinite(value)) return IoStatus::NotFinite;
  if (reset_wanted_.exchange(false)) {
    for (DriveNode& drive : drives_)
      drive.requestFaultReset();
  }
  PortStatus worst = sendHeartbeatWhenDue();
  const auto note = [&](PortStatus status) {
    if (worst == PortStatus::Ok) worst = status;
  };
  std::array<double, kAxes> sent{};
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const std::int16_t torque =
        drives_[i].isEnabled() ? toPerMille(volts[i], units_[i], torque_limits_[i]) : std::int16_t{0};
    note(sendCommand(i, torque));
    drives_[i].torqueSent(torque);
    sent[i] = voltsOf(torque, units_[i]);
  }
  note(process_.send(syncFrame()));
  const std::int64_t now = process_.now();
  // After trouble of the whole bus what the drives said last is old.
  const bool current = now - troubled_ns_ > nanoseconds(settings_.enable_delay_s);
  for (DriveNode& drive : drives_) {
    drive.syncSent();
    if (current && drive.takeNetworkStop(now)) note(process_.send(nmtFrame(NmtCommand::Stop, drive.node())));
  }
  const IoStatus status = statusOf(worst);
  if (status == IoStatus::Ok) written = sent;
  return status;
}

IoStatus CanAxisBus::writeOutputs(std::uint8_t bits) noexcept {
  if (!ready_) return IoStatus::NotReady;
  if (bits > 0x0F) return IoStatus::OutOfRange;
  const bool enable = (bits >> settings_.drive_enable_bit & 1) != 0;
  const std::int64_t now = process_.now();
  PortStatus worst = PortStatus::Ok;
  for (DriveNode& drive : drives_) {
    drive.setGoal(enable ? DriveGoal::Enabled : DriveGoal::Off, now);
    const PortStatus status = process_.send(outputsFrame(drive.node(), bits));
    if (worst == PortStatus::Ok) worst = status;
  }
  return statusOf(worst);
}

}  // namespace knee_robot::hardware::can
