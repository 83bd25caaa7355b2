#include "knee_robot/hardware/can/sdo.h"

#include <cstdio>

#include "knee_robot/hardware/can/canopen.h"

namespace knee_robot::hardware::can {
namespace {

constexpr unsigned kDownload = 1;  // client: write; server: answer to a segment
constexpr unsigned kUpload = 2;    // client and server: read
constexpr unsigned kDownloaded = 3;
constexpr unsigned kAbort = 4;
constexpr std::uint8_t kExpedited = 0x02;
constexpr std::uint8_t kSized = 0x01;

bool isSdo(const Frame& frame, std::uint32_t id) noexcept {
  return !frame.extended && !frame.remote && !frame.error && frame.id == id && frame.length == 8;
}

objects::Object objectIn(const Frame& frame) noexcept {
  return objects::object(static_cast<std::uint16_t>(unsignedAt(frame, 1, 2)), frame.data[3]);
}

/// Command byte of an expedited transfer of `size` bytes.
std::uint8_t expedited(unsigned command, int size) noexcept {
  return static_cast<std::uint8_t>(command << 5 | static_cast<unsigned>(4 - size) << 2 | kExpedited | kSized);
}

/// Bytes in an expedited transfer; without a stated size all four.
int sizeIn(std::uint8_t command) noexcept {
  return (command & kSized) != 0 ? 4 - (command >> 2 & 3) : 4;
}

std::uint32_t valueIn(const Frame& frame, int size) noexcept {
  return unsignedAt(frame, 4, static_cast<std::size_t>(size));
}

Frame frameFor(std::uint32_t id, std::uint8_t command, objects::Object object) noexcept {
  Frame frame;
  frame.id = id;
  frame.length = 8;
  frame.data[0] = command;
  putUnsigned(frame, 1, 2, objects::indexOf(object));
  frame.data[3] = objects::subindexOf(object);
  return frame;
}

std::string hexadecimal(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%X", value);
  return text;
}

}  // namespace

std::string objectName(objects::Object object) {
  char text[16];
  std::snprintf(text, sizeof text, "%04X:%02X", objects::indexOf(object), objects::subindexOf(object));
  return text;
}

Frame requestFrame(int node, const SdoRequest& request) noexcept {
  const std::uint8_t command =
      request.write ? expedited(kDownload, request.size) : static_cast<std::uint8_t>(kUpload << 5);
  Frame frame = frameFor(kSdoRequestBase + static_cast<std::uint32_t>(node), command, request.object);
  if (request.write) putUnsigned(frame, 4, static_cast<std::size_t>(request.size), request.value);
  return frame;
}

Frame answerFrame(int node, const SdoAnswer& answer) noexcept {
  const std::uint8_t command = answer.abort != 0 ? static_cast<std::uint8_t>(kAbort << 5)
                               : answer.written  ? static_cast<std::uint8_t>(kDownloaded << 5)
                                                 : expedited(kUpload, answer.size);
  Frame frame = frameFor(kSdoAnswerBase + static_cast<std::uint32_t>(node), command, answer.object);
  if (answer.abort != 0) {
    putUnsigned(frame, 4, 4, answer.abort);
  } else if (!answer.written) {
    putUnsigned(frame, 4, static_cast<std::size_t>(answer.size), answer.value);
  }
  return frame;
}

std::optional<SdoRequest> parseRequest(const Frame& frame, int node) noexcept {
  if (!isSdo(frame, kSdoRequestBase + static_cast<std::uint32_t>(node))) return std::nullopt;
  SdoRequest request;
  request.object = objectIn(frame);
  const unsigned command = frame.data[0] >> 5;
  if (command == kUpload) return request;
  request.write = true;
  const bool usable = command == kDownload && (frame.data[0] & kExpedited) != 0;
  request.size = usable ? sizeIn(frame.data[0]) : -1;
  if (usable) request.value = valueIn(frame, request.size);
  return request;
}

std::optional<SdoAnswer> parseAnswer(const Frame& frame, int node) noexcept {
  if (!isSdo(frame, kSdoAnswerBase + static_cast<std::uint32_t>(node))) return std::nullopt;
  SdoAnswer answer;
  answer.object = objectIn(frame);
  const unsigned command = frame.data[0] >> 5;
  if (command == kDownloaded) {
    answer.written = true;
  } else if (command == kAbort) {
    answer.abort = unsignedAt(frame, 4, 4);
    if (answer.abort == 0) answer.abort = kSdoGeneral;
  } else if (command == kUpload && (frame.data[0] & kExpedited) != 0) {
    answer.size = sizeIn(frame.data[0]);
    answer.value = valueIn(frame, answer.size);
  } else {
    answer.abort = kSdoUnsupported;
  }
  return answer;
}

const char* abortText(std::uint32_t code) noexcept {
  switch (code) {
    case 0x05030000:
      return "toggle bit not alternated";
    case kSdoTimeout:
      return "no answer in time";
    case kSdoUnsupported:
      return "transfer not supported: only expedited ones are";
    case 0x05040005:
      return "out of memory";
    case 0x06010000:
      return "unsupported access to an object";
    case kSdoWriteOnly:
      return "attempt to read a write-only object";
    case kSdoReadOnly:
      return "attempt to write a read-only object";
    case kSdoNoObject:
      return "object does not exist";
    case kSdoNotMappable:
      return "object cannot be mapped to a PDO";
    case kSdoPdoTooLong:
      return "mapped objects exceed the PDO's length";
    case 0x06040043:
      return "incompatible parameters";
    case 0x06040047:
      return "internal incompatibility in the device";
    case 0x06060000:
      return "access failed because of a hardware error";
    case kSdoWrongSize:
      return "length does not match the object's type";
    case 0x06070012:
      return "length too high";
    case 0x06070013:
      return "length too low";
    case kSdoNoSubindex:
      return "subindex does not exist";
    case kSdoOutOfRange:
      return "value out of range";
    case 0x06090031:
      return "value too high";
    case 0x06090032:
      return "value too low";
    case 0x06090036:
      return "maximum is less than minimum";
    case kSdoGeneral:
      return "general error";
    case 0x08000020:
      return "data cannot be stored";
    case 0x08000021:
      return "data cannot be stored because of local control";
    case kSdoWrongState:
      return "not in this device state";
    default:
      return "unknown abort code";
  }
}

SdoClient::SdoClient(FramePort& port, int node, std::int64_t timeout_ns)
    : port_(port), node_(node), timeout_ns_(timeout_ns) {}

std::string SdoClient::name(objects::Object object) const {
  return "node " + std::to_string(node_) + ", object " + objectName(object) + ": ";
}

SdoAnswer SdoClient::exchange(const SdoRequest& request) {
  constexpr std::int64_t kPause_ns = 200'000;
  const std::int64_t end = port_.now() + timeout_ns_;
  Frame frame;
  PortStatus status = port_.receive(frame);
  for (int i = 0; i < 1000 && status != PortStatus::Empty && status != PortStatus::Down; ++i)
    status = port_.receive(frame);  // late answers to earlier questions
  status = port_.send(requestFrame(node_, request));
  while (status == PortStatus::Full && port_.now() < end) {
    port_.pause(kPause_ns);
    status = port_.send(requestFrame(node_, request));
  }
  if (status != PortStatus::Ok) throw SdoError(name(request.object) + "the bus takes no frame: is it up?", 0);
  while (port_.now() < end) {
    status = port_.receive(frame);
    if (status == PortStatus::Down) throw SdoError(name(request.object) + "the interface went down", 0);
    if (status == PortStatus::Empty) port_.pause(kPause_ns);
    if (status != PortStatus::Ok) continue;
    const std::optional<SdoAnswer> answer = parseAnswer(frame, node_);
    if (!answer || answer->object != request.object) continue;
    if (answer->abort != 0) {
      throw SdoError(name(request.object) + abortText(answer->abort) + " (" + hexadecimal(answer->abort) + ")",
                     answer->abort);
    }
    if (answer->written == request.write) return *answer;
  }
  throw SdoError(name(request.object) + "no answer: node without power, other node number or bit rate", kSdoTimeout);
}

std::uint32_t SdoClient::readRaw(objects::Object object, int size) {
  const SdoAnswer answer = exchange({false, object, 0, 0});
  if (answer.size != size) {
    throw SdoError(name(object) + std::to_string(answer.size) + " bytes instead of " + std::to_string(size), 0);
  }
  return answer.value;
}

void SdoClient::writeRaw(objects::Object object, int size, std::uint32_t value) {
  exchange({true, object, size, value});
}

void SdoClient::requireEqual(objects::Object object, std::uint32_t wanted, std::uint32_t found) const {
  if (wanted == found) return;
  throw SdoError(name(object) + "reads back " + hexadecimal(found) + " instead of " + hexadecimal(wanted), 0);
}

}  // namespace knee_robot::hardware::can
