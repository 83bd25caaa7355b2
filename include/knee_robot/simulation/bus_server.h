#pragma once

#include <poll.h>

#include <string>
#include <vector>

#include "knee_robot/hardware/can/can_socket.h"

namespace knee_robot::simulation {

/// A simulated CAN bus on a kernel without CAN: a SEQPACKET Unix socket at a path, to which programs connect as to an
/// interface.
/// A frame of one goes to all others and to the owner of this, and the owner's frames go to all. No bit rate, no
/// arbitration; a peer that does not read loses frames. For simulators; not real-time.
class BusServer : public hardware::can::FramePort {
 public:
  /// Throws InputError when the path cannot be bound. A socket that nobody serves any more is replaced; a served one is
  /// refused.
  explicit BusServer(const std::string& path);
  /// Closes all and removes the path.
  ~BusServer() override;
  BusServer(const BusServer&) = delete;
  BusServer& operator=(const BusServer&) = delete;

  hardware::can::PortStatus send(const hardware::can::Frame& frame) noexcept override;
  /// Next frame of any peer, after it has been passed on to the others.
  hardware::can::PortStatus receive(hardware::can::Frame& frame) noexcept override;
  std::int64_t now() noexcept override;
  void pause(std::int64_t duration_ns) override;

  /// While set nobody is connected: what a pulled adapter is to a program.
  void hangUp(bool on);

  /// Waits for something to receive, at most until `deadline_ns`; lets new peers in.
  void wait(std::int64_t deadline_ns);

 private:
  void accept();
  void forward(const hardware::can::Frame& frame, const hardware::can::CanSocket* sender) noexcept;

  std::string path_;
  int listener_;
  std::vector<std::unique_ptr<hardware::can::CanSocket>> peers_;
  std::vector<pollfd> watched_;
  std::size_t next_ = 0;
  bool hung_up_ = false;
};

}  // namespace knee_robot::simulation
