#include "knee_robot/simulation/drive_model.h"

#include <algorithm>

namespace knee_robot::hardware::can {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::int64_t kQuickStop_ns = 10 * kMillisecond;
constexpr std::uint32_t kInvalid = 0x80000000;
constexpr std::uint16_t kHeartbeatMissed = 0x8130;

std::uint16_t statusWordOf(DriveState state) noexcept {
  constexpr std::uint16_t kVoltagePresent = 0x0210;  // and remote
  switch (state) {
    case DriveState::SwitchOnDisabled:
      return 0x40 | kVoltagePresent;
    case DriveState::ReadyToSwitchOn:
      return 0x21 | kVoltagePresent;
    case DriveState::SwitchedOn:
      return 0x23 | kVoltagePresent;
    case DriveState::OperationEnabled:
      return 0x27 | kVoltagePresent;
    case DriveState::QuickStopActive:
      return 0x07 | kVoltagePresent;
    case DriveState::FaultReaction:
      return 0x0F | kVoltagePresent;
    case DriveState::Fault:
      return 0x08 | kVoltagePresent;
    case DriveState::NotReady:
    case DriveState::Unknown:
      break;
  }
  return 0;
}

/// Where a control word leads from a state; the state itself when nowhere.
DriveState following(DriveState state, std::uint16_t word) noexcept {
  using S = DriveState;
  const bool voltage = (word & 0x02) != 0;
  const bool no_quick_stop = (word & 0x04) != 0;
  const bool switch_on = (word & 0x01) != 0;
  const bool enable = (word & 0x08) != 0;
  if (state == S::NotReady || state == S::Fault || state == S::FaultReaction || state == S::Unknown) return state;
  if (!voltage) return S::SwitchOnDisabled;
  if (!no_quick_stop) {
    if (state == S::OperationEnabled) return S::QuickStopActive;
    return state == S::QuickStopActive ? state : S::SwitchOnDisabled;
  }
  if (state == S::QuickStopActive) return switch_on && enable ? S::OperationEnabled : state;
  if (!switch_on) return S::ReadyToSwitchOn;
  if (state == S::SwitchOnDisabled) return state;
  if (state == S::ReadyToSwitchOn) return S::SwitchedOn;
  return enable ? S::OperationEnabled : S::SwitchedOn;
}

std::uint16_t pdoIndex(std::uint16_t base, int number) noexcept {
  return static_cast<std::uint16_t>(base + number);
}

}  // namespace

DriveModel::DriveModel(int node, ObjectDictionary dictionary, FramePort& bus)
    : node_(node), defaults_(dictionary), dictionary_(std::move(dictionary)), bus_(bus) {
  setState(DriveState::SwitchOnDisabled);
}

void DriveModel::send(const Frame& frame) noexcept {
  if (!silent_) bus_.send(frame);
}

void DriveModel::powerUp() noexcept {
  control_word_ = 0;
  setState(DriveState::SwitchOnDisabled);
  resetCommunication();
}

/// The communication objects get their defaults; what the motor and the profile have stays.
void DriveModel::resetCommunication() noexcept {
  const ObjectDictionary before = dictionary_;
  loadDefaults();
  for (const objects::Object kept :
       {objects::kPosition, objects::kDigitalInputs, objects::kErrorCode, objects::kDigitalOutputs,
        objects::kStatusWord, objects::kRatedTorque, objects::kNominalCurrent, objects::kCurrentLimit, objects::kVendor,
        objects::kProduct, objects::kSerial, objects::kDeviceType})
    dictionary_.set(kept, before.get(kept));
  is_staged_.fill(false);
  heard_ns_ = -1;
  nmt_ = NmtState::BootUp;
  send(heartbeatFrame(node_, NmtState::BootUp));
  nmt_ = NmtState::PreOperational;
}

void DriveModel::enter(NmtState state) noexcept {
  const bool leaves = nmt_ == NmtState::Operational && state != NmtState::Operational;
  nmt_ = state;
  if (leaves) connectionLost();
}

void DriveModel::obey(const NmtOrder& order) noexcept {
  if (order.node != 0 && order.node != node_) return;
  switch (order.command) {
    case NmtCommand::Start:
      return enter(NmtState::Operational);
    case NmtCommand::Stop:
      return enter(NmtState::Stopped);
    case NmtCommand::EnterPreOperational:
      return enter(NmtState::PreOperational);
    case NmtCommand::ResetNode:
      return powerUp();
    case NmtCommand::ResetCommunication:
      enter(NmtState::PreOperational);
      return resetCommunication();
  }
}

void DriveModel::take(const Frame& frame) noexcept {
  if (silent_ || frame.error) return;
  if (const auto order = parseNmt(frame)) return obey(*order);
  if (isSync(frame)) return sync();
  if (const auto beat = parseHeartbeat(frame)) {
    const auto watched = static_cast<std::uint32_t>(dictionary_.get(objects::kConsumerHeartbeat));
    if (static_cast<int>(watched >> 16 & 0x7F) == beat->node) heard_ns_ = now_;
    return;
  }
  const auto request = nmt_ == NmtState::Stopped ? std::nullopt : parseRequest(frame, node_);
  if (request) return serve(*request);
  if (nmt_ == NmtState::Operational) takeProcessData(frame);
}

void DriveModel::serve(const SdoRequest& request) noexcept {
  SdoAnswer answer;
  answer.object = request.object;
  answer.written = request.write;
  if (request.size < 0) {
    answer.abort = kSdoUnsupported;
  } else if (request.write) {
    answer.abort = write(request);
  } else {
    answer.abort = dictionary_.checkRead(request.object);
    if (const DictionaryEntry* entry = dictionary_.find(request.object)) {
      answer.size = entry->size;
      answer.value = entry->value;
    }
  }
  send(answerFrame(node_, answer));
}

/// A PDO's parameters change only while it is switched off, its entries only while their number is 0.
std::uint32_t DriveModel::checkPdoChange(const SdoRequest& request) const noexcept {
  const std::uint16_t index = objects::indexOf(request.object);
  const std::uint8_t subindex = objects::subindexOf(request.object);
  const std::uint16_t base = index & 0xFE00;
  const bool mapping = base == objects::kReceivePdoMapping || base == objects::kTransmitPdoMapping;
  const bool communication = base == objects::kReceivePdo || base == objects::kTransmitPdo;
  if (!mapping && !communication) return 0;
  const auto owner = static_cast<std::uint16_t>(mapping ? index - 0x200 : index);
  const bool valid = (dictionary_.get(objects::object(owner, 1)) & kInvalid) == 0;
  if (communication) return valid && subindex != 1 ? kSdoWrongState : 0;
  if (valid) return kSdoWrongState;
  if (subindex == 0) return request.value > 8 ? kSdoOutOfRange : 0;
  if (dictionary_.get(objects::object(index, 0)) != 0) return kSdoWrongState;
  const DictionaryEntry* mapped = dictionary_.find(request.value >> 8);
  if (mapped == nullptr || !mapped->mappable) return kSdoNotMappable;
  return static_cast<int>(request.value & 0xFF) == 8 * mapped->size ? 0 : kSdoNotMappable;
}

std::uint32_t DriveModel::write(const SdoRequest& request) noexcept {
  std::uint32_t abort = dictionary_.checkWrite(request.object, request.size);
  if (abort == 0) abort = checkPdoChange(request);
  if (abort == 0 && refusal_ != 0 && request.object == refused_) abort = refusal_;
  if (abort == 0 && request.object == objects::kMode &&
      static_cast<std::int8_t>(request.value) != objects::kCyclicTorque && request.value != 0) {
    abort = kSdoOutOfRange;
  }
  if (abort != 0) return abort;
  dictionary_.set(request.object, request.value);
  if (request.object == objects::kMode) dictionary_.set(objects::kModeDisplay, request.value);
  if (request.object == objects::kControlWord) control(static_cast<std::uint16_t>(request.value));
  return 0;
}

void DriveModel::refuseObject(objects::Object object, std::uint32_t abort) noexcept {
  refused_ = object;
  refusal_ = abort;
}

void DriveModel::takeProcessData(const Frame& frame) noexcept {
  if (frame.extended || frame.remote) return;
  for (int number = 0; number < 4; ++number) {
    const std::uint16_t index = pdoIndex(objects::kReceivePdo, number);
    const auto id = static_cast<std::uint32_t>(dictionary_.get(objects::object(index, 1)));
    if (dictionary_.find(objects::object(index, 1)) == nullptr || (id & kInvalid) != 0 || (id & 0x7FF) != frame.id)
      continue;
    const auto slot = static_cast<std::size_t>(number);
    staged_[slot] = frame;
    is_staged_[slot] = true;
    if (dictionary_.get(objects::object(index, 2)) > 240) applyProcessData(number);
  }
}

void DriveModel::applyProcessData(int number) noexcept {
  const auto slot = static_cast<std::size_t>(number);
  if (!is_staged_[slot]) return;
  is_staged_[slot] = false;
  const std::uint16_t index = pdoIndex(objects::kReceivePdoMapping, number);
  const auto count = static_cast<std::uint8_t>(dictionary_.get(objects::object(index, 0)));
  std::size_t offset = 0;
  for (std::uint8_t i = 1; i <= count && i <= 8; ++i) {
    const auto entry = static_cast<std::uint32_t>(dictionary_.get(objects::object(index, i)));
    const std::size_t bytes = (entry & 0xFF) / 8;
    if (offset + bytes > staged_[slot].length) return;  // a shorter frame than mapped: the rest is missing
    const std::uint32_t value = unsignedAt(staged_[slot], offset, bytes);
    dictionary_.set(entry >> 8, value);
    if (entry >> 8 == objects::kControlWord) control(static_cast<std::uint16_t>(value));
    offset += bytes;
  }
}

void DriveModel::sync() noexcept {
  if (nmt_ != NmtState::Operational) return;
  for (int number = 0; number < 4; ++number)
    applyProcessData(number);
  dictionary_.set(objects::kTorque, torque());
  for (int number = 0; number < 4; ++number) {
    const std::uint16_t index = pdoIndex(objects::kTransmitPdo, number);
    const auto* id = dictionary_.find(objects::object(index, 1));
    const bool on = id != nullptr && (id->value & kInvalid) == 0 && dictionary_.get(objects::object(index, 2)) == 1;
    if (on) sendProcessData(number);
  }
}

void DriveModel::sendProcessData(int number) noexcept {
  const std::uint16_t index = pdoIndex(objects::kTransmitPdoMapping, number);
  Frame frame;
  frame.id =
      static_cast<std::uint32_t>(dictionary_.get(objects::object(pdoIndex(objects::kTransmitPdo, number), 1))) & 0x7FF;
  const auto count = static_cast<std::uint8_t>(dictionary_.get(objects::object(index, 0)));
  std::size_t offset = 0;
  for (std::uint8_t i = 1; i <= count && i <= 8; ++i) {
    const auto entry = static_cast<std::uint32_t>(dictionary_.get(objects::object(index, i)));
    const std::size_t bytes = (entry & 0xFF) / 8;
    if (offset + bytes > 8) break;
    putUnsigned(frame, offset, bytes, static_cast<std::uint32_t>(dictionary_.get(entry >> 8)));
    offset += bytes;
  }
  frame.length = static_cast<std::uint8_t>(offset);
  send(frame);
}

void DriveModel::setState(DriveState state) noexcept {
  if (state == DriveState::QuickStopActive && state_ != state) quick_stop_ends_ns_ = now_ + kQuickStop_ns;
  state_ = state;
  dictionary_.set(objects::kStatusWord, statusWordOf(state));
}

void DriveModel::control(std::uint16_t word) noexcept {
  const bool reset_edge = (word & kFaultReset) != 0 && (control_word_ & kFaultReset) == 0;
  control_word_ = word;
  if (state_ == DriveState::Fault && reset_edge) {
    dictionary_.set(objects::kErrorCode, 0);
    dictionary_.set(objects::kErrorRegister, 0);
    setState(DriveState::SwitchOnDisabled);
    send(emergencyFrame({node_, 0, 0}));
    return;
  }
  setState(following(state_, word));
}

void DriveModel::fail(std::uint16_t code) noexcept {
  dictionary_.set(objects::kErrorCode, code);
  dictionary_.set(objects::kErrorRegister, 1);
  setState(DriveState::Fault);
  send(emergencyFrame({node_, code, 1}));
}

void DriveModel::warn(std::uint16_t code) noexcept {
  send(emergencyFrame({node_, code, 1}));
}

/// 6007: 1 fault, 2 power stage off, 3 quick stop, else nothing. The digital outputs fall: the brakes engage.
void DriveModel::connectionLost() noexcept {
  const auto option = dictionary_.get(objects::kAbortConnection);
  is_staged_.fill(false);
  dictionary_.set(objects::kDigitalOutputs, 0);
  if (option == 1) fail(kHeartbeatMissed);
  if (option == 2) setState(following(state_, kDisableVoltage));
  if (option == objects::kQuickStopOnLoss) setState(following(state_, kQuickStop));
}

void DriveModel::step(std::int64_t now) noexcept {
  now_ = now;
  if (state_ == DriveState::QuickStopActive && now_ >= quick_stop_ends_ns_) setState(DriveState::SwitchOnDisabled);
  const auto period = dictionary_.get(objects::kProducerHeartbeat) * kMillisecond;
  if (beats_ && period > 0 && now_ >= next_beat_ns_) {
    next_beat_ns_ = std::max(next_beat_ns_ + period, now_ - period);
    send(heartbeatFrame(node_, nmt_));
  }
  const std::int64_t patience = (dictionary_.get(objects::kConsumerHeartbeat) & 0xFFFF) * kMillisecond;
  if (heard_ns_ >= 0 && patience > 0 && now_ - heard_ns_ > patience) {
    heard_ns_ = -1;
    send(emergencyFrame({node_, kHeartbeatMissed, 0x11}));
    connectionLost();
  }
}

void DriveModel::setPosition(std::int32_t counts) noexcept {
  dictionary_.set(objects::kPosition, counts);
}

void DriveModel::setInputs(std::uint8_t bits) noexcept {
  dictionary_.set(objects::kDigitalInputs, static_cast<std::int64_t>(bits & 0x0F) << objects::kFirstLine);
}

std::int16_t DriveModel::torque() const noexcept {
  if (state_ != DriveState::OperationEnabled) return 0;
  const auto nominal = std::max<std::int64_t>(1, dictionary_.get(objects::kNominalCurrent));
  const auto limit = std::min<std::int64_t>(32767, 1000 * dictionary_.get(objects::kCurrentLimit) / nominal);
  const std::int64_t target = dictionary_.get(objects::kTargetTorque);
  return static_cast<std::int16_t>(std::clamp<std::int64_t>(target, -limit, limit));
}

std::uint8_t DriveModel::outputs() const noexcept {
  return static_cast<std::uint8_t>(dictionary_.get(objects::kDigitalOutputs) >> objects::kFirstLine & 0x0F);
}

}  // namespace knee_robot::hardware::can
