#include "knee_robot/simulation/drive_model.h"

#include <algorithm>

namespace knee_robot::simulation {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::int64_t kQuickStop_ns = 10 * kMillisecond;
constexpr std::uint32_t kInvalid = 0x80000000;
constexpr std::uint16_t kHeartbeatMissed = 0x8130;

std::uint16_t statusWordOf(hardware::can::DriveState state) noexcept {
  constexpr std::uint16_t kVoltagePresent = 0x0210;  // and remote
  switch (state) {
    case hardware::can::DriveState::SwitchOnDisabled:
      return 0x40 | kVoltagePresent;
    case hardware::can::DriveState::ReadyToSwitchOn:
      return 0x21 | kVoltagePresent;
    case hardware::can::DriveState::SwitchedOn:
      return 0x23 | kVoltagePresent;
    case hardware::can::DriveState::OperationEnabled:
      return 0x27 | kVoltagePresent;
    case hardware::can::DriveState::QuickStopActive:
      return 0x07 | kVoltagePresent;
    case hardware::can::DriveState::FaultReaction:
      return 0x0F | kVoltagePresent;
    case hardware::can::DriveState::Fault:
      return 0x08 | kVoltagePresent;
    case hardware::can::DriveState::NotReady:
    case hardware::can::DriveState::Unknown:
      break;
  }
  return 0;
}

/// Where a control word leads from a state; the state itself when nowhere.
hardware::can::DriveState following(hardware::can::DriveState state, std::uint16_t word) noexcept {
  using S = hardware::can::DriveState;
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

DriveModel::DriveModel(int node, hardware::can::ObjectDictionary dictionary, hardware::can::FramePort& bus)
    : node_(node), defaults_(dictionary), dictionary_(std::move(dictionary)), bus_(bus) {
  setState(hardware::can::DriveState::SwitchOnDisabled);
}

void DriveModel::send(const hardware::can::Frame& frame) noexcept {
  if (!silent_) bus_.send(frame);
}

/// Nothing outlives it but what the maker's tool has stored: the digital outputs are off.
void DriveModel::powerUp() noexcept {
  control_word_ = 0;
  dictionary_.set(hardware::can::objects::kDigitalOutputs, 0);
  setState(hardware::can::DriveState::SwitchOnDisabled);
  resetCommunication();
}

/// The communication objects get their defaults; what the motor and the profile have stays.
void DriveModel::resetCommunication() noexcept {
  const hardware::can::ObjectDictionary before = dictionary_;
  loadDefaults();
  for (const hardware::can::objects::Object kept :
       {hardware::can::objects::kPosition, hardware::can::objects::kDigitalInputs, hardware::can::objects::kErrorCode,
        hardware::can::objects::kDigitalOutputs, hardware::can::objects::kStatusWord,
        hardware::can::objects::kRatedTorque, hardware::can::objects::kNominalCurrent,
        hardware::can::objects::kCurrentLimit, hardware::can::objects::kVendor, hardware::can::objects::kProduct,
        hardware::can::objects::kSerial, hardware::can::objects::kDeviceType})
    dictionary_.set(kept, before.get(kept));
  is_staged_.fill(false);
  heard_ns_ = -1;
  nmt_ = hardware::can::NmtState::BootUp;
  send(hardware::can::heartbeatFrame(node_, hardware::can::NmtState::BootUp));
  nmt_ = hardware::can::NmtState::PreOperational;
}

void DriveModel::enter(hardware::can::NmtState state) noexcept {
  const bool leaves = nmt_ == hardware::can::NmtState::Operational && state != hardware::can::NmtState::Operational;
  nmt_ = state;
  if (leaves) connectionLost();
}

void DriveModel::obey(const hardware::can::NmtOrder& order) noexcept {
  if (order.node != 0 && order.node != node_) return;
  switch (order.command) {
    case hardware::can::NmtCommand::Start:
      return enter(hardware::can::NmtState::Operational);
    case hardware::can::NmtCommand::Stop:
      return enter(hardware::can::NmtState::Stopped);
    case hardware::can::NmtCommand::EnterPreOperational:
      return enter(hardware::can::NmtState::PreOperational);
    case hardware::can::NmtCommand::ResetNode:
      return powerUp();
    case hardware::can::NmtCommand::ResetCommunication:
      enter(hardware::can::NmtState::PreOperational);
      return resetCommunication();
  }
}

void DriveModel::take(const hardware::can::Frame& frame) noexcept {
  if (silent_ || frame.error) return;
  if (const auto order = hardware::can::parseNmt(frame)) return obey(*order);
  if (hardware::can::isSync(frame)) return sync();
  if (const auto beat = hardware::can::parseHeartbeat(frame)) {
    const auto watched = static_cast<std::uint32_t>(dictionary_.get(hardware::can::objects::kConsumerHeartbeat));
    if (static_cast<int>(watched >> 16 & 0x7F) == beat->node) heard_ns_ = now_;
    return;
  }
  const auto request =
      nmt_ == hardware::can::NmtState::Stopped ? std::nullopt : hardware::can::parseRequest(frame, node_);
  if (request) return serve(*request);
  if (nmt_ == hardware::can::NmtState::Operational) takeProcessData(frame);
}

void DriveModel::serve(const hardware::can::SdoRequest& request) noexcept {
  hardware::can::SdoAnswer answer;
  answer.object = request.object;
  answer.written = request.write;
  if (request.size < 0) {
    answer.abort = hardware::can::kSdoUnsupported;
  } else if (request.write) {
    answer.abort = write(request);
  } else {
    answer.abort = dictionary_.checkRead(request.object);
    if (const hardware::can::DictionaryEntry* entry = dictionary_.find(request.object)) {
      answer.size = entry->size;
      answer.value = entry->value;
    }
  }
  send(hardware::can::answerFrame(node_, answer));
}

/// A PDO's parameters change only while it is switched off, its entries only while their number is 0.
std::uint32_t DriveModel::checkPdoChange(const hardware::can::SdoRequest& request) const noexcept {
  const std::uint16_t index = hardware::can::objects::indexOf(request.object);
  const std::uint8_t subindex = hardware::can::objects::subindexOf(request.object);
  const std::uint16_t base = index & 0xFE00;
  const bool mapping =
      base == hardware::can::objects::kReceivePdoMapping || base == hardware::can::objects::kTransmitPdoMapping;
  const bool communication =
      base == hardware::can::objects::kReceivePdo || base == hardware::can::objects::kTransmitPdo;
  if (!mapping && !communication) return 0;
  const auto owner = static_cast<std::uint16_t>(mapping ? index - 0x200 : index);
  const bool valid = (dictionary_.get(hardware::can::objects::object(owner, 1)) & kInvalid) == 0;
  if (communication) return valid && subindex != 1 ? hardware::can::kSdoWrongState : 0;
  if (valid) return hardware::can::kSdoWrongState;
  if (subindex == 0) return request.value > 8 ? hardware::can::kSdoOutOfRange : 0;
  if (dictionary_.get(hardware::can::objects::object(index, 0)) != 0) return hardware::can::kSdoWrongState;
  const hardware::can::DictionaryEntry* mapped = dictionary_.find(request.value >> 8);
  if (mapped == nullptr || !mapped->mappable) return hardware::can::kSdoNotMappable;
  return static_cast<int>(request.value & 0xFF) == 8 * mapped->size ? 0 : hardware::can::kSdoNotMappable;
}

std::uint32_t DriveModel::write(const hardware::can::SdoRequest& request) noexcept {
  std::uint32_t abort = dictionary_.checkWrite(request.object, request.size);
  if (abort == 0) abort = checkPdoChange(request);
  if (abort == 0 && refusal_ != 0 && request.object == refused_) abort = refusal_;
  if (abort == 0 && request.object == hardware::can::objects::kMode &&
      static_cast<std::int8_t>(request.value) != hardware::can::objects::kCyclicTorque && request.value != 0) {
    abort = hardware::can::kSdoOutOfRange;
  }
  if (abort != 0) return abort;
  dictionary_.set(request.object, request.value);
  if (request.object == hardware::can::objects::kMode)
    dictionary_.set(hardware::can::objects::kModeDisplay, request.value);
  if (request.object == hardware::can::objects::kControlWord) control(static_cast<std::uint16_t>(request.value));
  return 0;
}

void DriveModel::refuseObject(hardware::can::objects::Object object, std::uint32_t abort) noexcept {
  refused_ = object;
  refusal_ = abort;
}

void DriveModel::takeProcessData(const hardware::can::Frame& frame) noexcept {
  if (frame.extended || frame.remote) return;
  for (int number = 0; number < 4; ++number) {
    const std::uint16_t index = pdoIndex(hardware::can::objects::kReceivePdo, number);
    const auto id = static_cast<std::uint32_t>(dictionary_.get(hardware::can::objects::object(index, 1)));
    if (dictionary_.find(hardware::can::objects::object(index, 1)) == nullptr || (id & kInvalid) != 0 ||
        (id & 0x7FF) != frame.id)
      continue;
    const auto slot = static_cast<std::size_t>(number);
    staged_[slot] = frame;
    is_staged_[slot] = true;
    if (dictionary_.get(hardware::can::objects::object(index, 2)) > 240) applyProcessData(number);
  }
}

void DriveModel::applyProcessData(int number) noexcept {
  const auto slot = static_cast<std::size_t>(number);
  if (!is_staged_[slot]) return;
  is_staged_[slot] = false;
  const std::uint16_t index = pdoIndex(hardware::can::objects::kReceivePdoMapping, number);
  const auto count = static_cast<std::uint8_t>(dictionary_.get(hardware::can::objects::object(index, 0)));
  std::size_t offset = 0;
  for (std::uint8_t i = 1; i <= count && i <= 8; ++i) {
    const auto entry = static_cast<std::uint32_t>(dictionary_.get(hardware::can::objects::object(index, i)));
    const std::size_t bytes = (entry & 0xFF) / 8;
    if (offset + bytes > staged_[slot].length) return;  // a shorter frame than mapped: the rest is missing
    const std::uint32_t value = hardware::can::unsignedAt(staged_[slot], offset, bytes);
    dictionary_.set(entry >> 8, value);
    if (entry >> 8 == hardware::can::objects::kControlWord) control(static_cast<std::uint16_t>(value));
    offset += bytes;
  }
}

void DriveModel::sync() noexcept {
  if (nmt_ != hardware::can::NmtState::Operational) return;
  for (int number = 0; number < 4; ++number)
    applyProcessData(number);
  dictionary_.set(hardware::can::objects::kTorque, torque());
  for (int number = 0; number < 4; ++number) {
    const std::uint16_t index = pdoIndex(hardware::can::objects::kTransmitPdo, number);
    const auto* id = dictionary_.find(hardware::can::objects::object(index, 1));
    const bool on =
        id != nullptr && (id->value & kInvalid) == 0 && dictionary_.get(hardware::can::objects::object(index, 2)) == 1;
    if (on) sendProcessData(number);
  }
}

void DriveModel::sendProcessData(int number) noexcept {
  const std::uint16_t index = pdoIndex(hardware::can::objects::kTransmitPdoMapping, number);
  hardware::can::Frame frame;
  frame.id = static_cast<std::uint32_t>(dictionary_.get(
                 hardware::can::objects::object(pdoIndex(hardware::can::objects::kTransmitPdo, number), 1))) &
             0x7FF;
  const auto count = static_cast<std::uint8_t>(dictionary_.get(hardware::can::objects::object(index, 0)));
  std::size_t offset = 0;
  for (std::uint8_t i = 1; i <= count && i <= 8; ++i) {
    const auto entry = static_cast<std::uint32_t>(dictionary_.get(hardware::can::objects::object(index, i)));
    const std::size_t bytes = (entry & 0xFF) / 8;
    if (offset + bytes > 8) break;
    hardware::can::putUnsigned(frame, offset, bytes, static_cast<std::uint32_t>(dictionary_.get(entry >> 8)));
    offset += bytes;
  }
  frame.length = static_cast<std::uint8_t>(offset);
  send(frame);
}

void DriveModel::setState(hardware::can::DriveState state) noexcept {
  if (state == hardware::can::DriveState::QuickStopActive && state_ != state)
    quick_stop_ends_ns_ = now_ + kQuickStop_ns;
  state_ = state;
  dictionary_.set(hardware::can::objects::kStatusWord, statusWordOf(state));
}

void DriveModel::control(std::uint16_t word) noexcept {
  const bool reset_edge = (word & hardware::can::kFaultReset) != 0 && (control_word_ & hardware::can::kFaultReset) == 0;
  control_word_ = word;
  if (state_ == hardware::can::DriveState::Fault && reset_edge) {
    dictionary_.set(hardware::can::objects::kErrorCode, 0);
    dictionary_.set(hardware::can::objects::kErrorRegister, 0);
    setState(hardware::can::DriveState::SwitchOnDisabled);
    send(hardware::can::emergencyFrame({node_, 0, 0}));
    return;
  }
  setState(following(state_, word));
}

void DriveModel::fail(std::uint16_t code) noexcept {
  dictionary_.set(hardware::can::objects::kErrorCode, code);
  dictionary_.set(hardware::can::objects::kErrorRegister, 1);
  setState(hardware::can::DriveState::Fault);
  send(hardware::can::emergencyFrame({node_, code, 1}));
}

void DriveModel::warn(std::uint16_t code) noexcept {
  send(hardware::can::emergencyFrame({node_, code, 1}));
}

/// 6007: 1 fault, 2 power stage off, 3 quick stop, else nothing. The digital outputs fall: the brakes engage.
void DriveModel::connectionLost() noexcept {
  const auto option = dictionary_.get(hardware::can::objects::kAbortConnection);
  is_staged_.fill(false);
  dictionary_.set(hardware::can::objects::kDigitalOutputs, 0);
  if (option == 1) fail(kHeartbeatMissed);
  if (option == 2) setState(following(state_, hardware::can::kDisableVoltage));
  if (option == hardware::can::objects::kQuickStopOnLoss) setState(following(state_, hardware::can::kQuickStop));
}

void DriveModel::step(std::int64_t now) noexcept {
  now_ = now;
  if (state_ == hardware::can::DriveState::QuickStopActive && now_ >= quick_stop_ends_ns_)
    setState(hardware::can::DriveState::SwitchOnDisabled);
  const auto period = dictionary_.get(hardware::can::objects::kProducerHeartbeat) * kMillisecond;
  if (beats_ && period > 0 && now_ >= next_beat_ns_) {
    next_beat_ns_ = std::max(next_beat_ns_ + period, now_ - period);
    send(hardware::can::heartbeatFrame(node_, nmt_));
  }
  const std::int64_t patience = (dictionary_.get(hardware::can::objects::kConsumerHeartbeat) & 0xFFFF) * kMillisecond;
  if (heard_ns_ >= 0 && patience > 0 && now_ - heard_ns_ > patience) {
    heard_ns_ = -1;
    send(hardware::can::emergencyFrame({node_, kHeartbeatMissed, 0x11}));
    connectionLost();
  }
}

void DriveModel::setPosition(std::int32_t counts) noexcept {
  dictionary_.set(hardware::can::objects::kPosition, counts);
}

void DriveModel::setInputs(std::uint8_t bits) noexcept {
  dictionary_.set(hardware::can::objects::kDigitalInputs, static_cast<std::int64_t>(bits & 0x0F)
                                                              << hardware::can::objects::kFirstLine);
}

std::int16_t DriveModel::torque() const noexcept {
  if (state_ != hardware::can::DriveState::OperationEnabled) return 0;
  const auto nominal = std::max<std::int64_t>(1, dictionary_.get(hardware::can::objects::kNominalCurrent));
  const auto limit =
      std::min<std::int64_t>(32767, 1000 * dictionary_.get(hardware::can::objects::kCurrentLimit) / nominal);
  const std::int64_t target = dictionary_.get(hardware::can::objects::kTargetTorque);
  return static_cast<std::int16_t>(std::clamp<std::int64_t>(target, -limit, limit));
}

std::uint8_t DriveModel::outputs() const noexcept {
  return static_cast<std::uint8_t>(
      dictionary_.get(hardware::can::objects::kDigitalOutputs) >> hardware::can::objects::kFirstLine & 0x0F);
}

}  // namespace knee_robot::simulation
