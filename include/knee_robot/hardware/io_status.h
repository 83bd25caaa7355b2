#pragma once

namespace knee_robot::hardware {

/// Outcome of every real-time hardware call. Anything but Ok means that the call had no effect on the outputs, unless
/// said otherwise where it is returned.
enum class IoStatus {
  Ok,
  NotFinite,     ///< a command is nan or infinite: refused whole
  OutOfRange,    ///< a channel, bit or register offset that the device does not have
  NotReady,      ///< the self test has not passed yet: outputs are refused
  Disconnected,  ///< the device does not answer: card gone, shared memory closed, lockdown
  DeviceError,   ///< the device answers, but not as it should (read-back differs, wrong board id)
  FencedOut,     ///< a guardian has taken the outputs: it brought them down and keeps them there
};

/// One plain word or two ("disconnected"), for messages outside the real-time path.
constexpr const char* toText(IoStatus status) noexcept {
  switch (status) {
    case IoStatus::Ok:
      return "ok";
    case IoStatus::NotFinite:
      return "command not finite";
    case IoStatus::OutOfRange:
      return "out of range";
    case IoStatus::NotReady:
      return "not ready, self test missing";
    case IoStatus::Disconnected:
      return "disconnected";
    case IoStatus::DeviceError:
      return "device error";
    case IoStatus::FencedOut:
      return "fenced out by the guardian";
  }
  return "unknown status";
}

}  // namespace knee_robot::hardware
