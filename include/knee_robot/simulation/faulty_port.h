#pragma once

#include <array>
#include <cstddef>

#include "knee_robot/hardware/can/frame_port.h"

namespace knee_robot::simulation {

/// What a bus can do to the frames that simulated drives send.
enum class WireFault : std::uint8_t {
  None,
  Cut,        ///< nothing arrives, either way
  Delayed,    ///< the feedback of every third period comes with that of the next
  Reordered,  ///< two feedbacks of one drive change places
  Flooded,    ///< hundreds of frames with a drive's identifier at each feedback
  BusOff,     ///< one error frame; then nothing
};

/// The drives' port with faults on the wire. For simulators and tests.
class FaultyPort : public hardware::can::FramePort {
 public:
  /// `port` must outlive this.
  explicit FaultyPort(hardware::can::FramePort& port) : port_(port) {}
  void set(WireFault fault) noexcept;

  hardware::can::PortStatus send(const hardware::can::Frame& frame) noexcept override;
  hardware::can::PortStatus receive(hardware::can::Frame& frame) noexcept override;
  std::int64_t now() noexcept override { return port_.now(); }
  void pause(std::int64_t duration_ns) override { port_.pause(duration_ns); }

 private:
  static constexpr std::size_t kNodes = 128;

  hardware::can::PortStatus delay(const hardware::can::Frame& frame, std::size_t node) noexcept;
  hardware::can::PortStatus reorder(const hardware::can::Frame& frame, std::size_t node) noexcept;
  hardware::can::PortStatus flood(const hardware::can::Frame& frame) noexcept;

  hardware::can::FramePort& port_;
  WireFault fault_ = WireFault::None;
  std::array<hardware::can::Frame, kNodes> held_{};
  std::array<bool, kNodes> is_held_{};
  std::array<int, kNodes> count_{};
};

}  // namespace knee_robot::simulation
