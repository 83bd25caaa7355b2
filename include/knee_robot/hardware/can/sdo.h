#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "knee_robot/hardware/can/cia402_objects.h"
#include "knee_robot/hardware/can/frame_port.h"

namespace knee_robot::hardware::can {

/// Expedited service data: one object of 1 to 4 bytes a request. Longer objects are not needed here and are refused.
struct SdoRequest {
  bool write = false;
  objects::Object object = 0;
  int size = 0;             ///< bytes, for a write
  std::uint32_t value = 0;  ///< for a write
};
/// What a node answers to an SdoRequest (CiA 301, expedited).
struct SdoAnswer {
  objects::Object object = 0;
  bool written = false;     ///< answer to a write
  int size = 0;             ///< bytes read
  std::uint32_t value = 0;  ///< read, not sign-extended
  std::uint32_t abort = 0;  ///< not 0: refused, with this code
};

Frame requestFrame(int node, const SdoRequest& request) noexcept;
Frame answerFrame(int node, const SdoAnswer& answer) noexcept;
/// Any frame may be given; nothing when it is no request to this node. A segmented or block request, or an abort:
/// object with size -1, to be refused with kSdoUnsupported.
std::optional<SdoRequest> parseRequest(const Frame& frame, int node) noexcept;
/// Nothing when it is no answer of this node. An answer that is not expedited has abort = kSdoUnsupported.
std::optional<SdoAnswer> parseAnswer(const Frame& frame, int node) noexcept;

inline constexpr std::uint32_t kSdoTimeout = 0x05040000;
inline constexpr std::uint32_t kSdoUnsupported = 0x05040001;
inline constexpr std::uint32_t kSdoReadOnly = 0x06010002;
inline constexpr std::uint32_t kSdoWriteOnly = 0x06010001;
inline constexpr std::uint32_t kSdoNoObject = 0x06020000;
inline constexpr std::uint32_t kSdoNotMappable = 0x06040041;
inline constexpr std::uint32_t kSdoPdoTooLong = 0x06040042;
inline constexpr std::uint32_t kSdoWrongSize = 0x06070010;
inline constexpr std::uint32_t kSdoNoSubindex = 0x06090011;
inline constexpr std::uint32_t kSdoOutOfRange = 0x06090030;
inline constexpr std::uint32_t kSdoWrongState = 0x08000022;
inline constexpr std::uint32_t kSdoGeneral = 0x08000000;

/// CiA 301's text of an abort code: "object does not exist".
const char* abortText(std::uint32_t code) noexcept;

/// Asks one node for its objects and waits for each answer. Not real-time. What goes wrong is thrown as SdoError.
class SdoClient {
 public:
  /// `port` must outlive this; answers of other nodes that it receives meanwhile are lost.
  SdoClient(FramePort& port, int node, std::int64_t timeout_ns = 200'000'000);
  int node() const noexcept { return node_; }

  /// Value, sign-extended when T is signed. The node has to send exactly sizeof(T) bytes.
  template <typename T>
  T read(objects::Object object) {
    return static_cast<T>(readRaw(object, sizeof(T)));
  }
  template <typename T>
  void write(objects::Object object, T value) {
    static_assert(sizeof(T) <= 4, "expedited");
    writeRaw(object, sizeof(T), static_cast<std::uint32_t>(value));
  }
  /// write, then read back; throws when another value comes back.
  template <typename T>
  void writeChecked(objects::Object object, T value) {
    write(object, value);
    requireEqual(object, static_cast<std::uint32_t>(value), static_cast<std::uint32_t>(read<T>(object)));
  }

 private:
  std::uint32_t readRaw(objects::Object object, int size);
  void writeRaw(objects::Object object, int size, std::uint32_t value);
  SdoAnswer exchange(const SdoRequest& request);
  void requireEqual(objects::Object object, std::uint32_t wanted, std::uint32_t found) const;
  std::string name(objects::Object object) const;

  FramePort& port_;
  int node_;
  std::int64_t timeout_ns_;
};

/// One sentence: node, object, and what the node or the bus answered. `abort` is the node's code, 0 when it is not
/// about one.
class SdoError : public std::exception {
 public:
  SdoError(std::string sentence, std::uint32_t abort) : sentence_(std::move(sentence)), abort_(abort) {}
  const char* what() const noexcept override { return sentence_.c_str(); }
  std::uint32_t abort() const noexcept { return abort_; }

 private:
  std::string sentence_;
  std::uint32_t abort_;
};

/// "6064:00"
std::string objectName(objects::Object object);

}  // namespace knee_robot::hardware::can
