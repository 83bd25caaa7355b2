#pragma once

#include <memory>
#include <string>
#include <vector>

#include "knee_robot/hardware/can/frame_port.h"

struct can_frame;

namespace knee_robot::hardware::can {

/// A frame passes when (id & mask) == id_wanted; 11-bit identifiers. No filter at all passes everything. Error frames
/// always pass.
struct Filter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0x7FF;
};

/// Non-blocking raw socket. Either a SocketCAN interface (filters in the kernel, error frames, the kernel's time
/// stamps), or a SEQPACKET Unix socket that carries whole `struct can_frame`s: a simulated bus on a kernel without CAN,
/// or a socket pair in a test. After the interface went down, send and receive answer Down until it is up again.
class CanSocket : public FramePort {
 public:
  /// `name` is an interface ("can0") when it has no slash, else the path of a simulated bus' socket. Throws InputError:
  /// no such interface, not up, no CAN in this kernel, nobody listens at the path.
  static std::unique_ptr<CanSocket> open(const std::string& name, const std::vector<Filter>& filters);
  /// One end of a connected SEQPACKET socket; takes it over.
  static std::unique_ptr<CanSocket> adopt(int descriptor, const std::vector<Filter>& filters);

  ~CanSocket() override;
  CanSocket(const CanSocket&) = delete;
  CanSocket& operator=(const CanSocket&) = delete;

  PortStatus send(const Frame& frame) noexcept override;
  PortStatus receive(Frame& frame) noexcept override;
  std::int64_t now() noexcept override;
  void pause(std::int64_t duration_ns) override;
  int descriptor() const noexcept { return descriptor_; }

 private:
  CanSocket(int descriptor, std::vector<Filter> filters, bool kernel_can)
      : descriptor_(descriptor), filters_(std::move(filters)), kernel_can_(kernel_can) {}
  bool passes(const Frame& frame) const noexcept;

  int descriptor_;
  std::vector<Filter> filters_;  // applied here only without the kernel's
  bool kernel_can_;
};

/// Frame of the kernel's structure; false when its length or identifier is impossible. Any bytes may be given.
bool fromKernel(const ::can_frame& raw, Frame& frame) noexcept;
void toKernel(const Frame& frame, ::can_frame& raw) noexcept;

}  // namespace knee_robot::hardware::can
