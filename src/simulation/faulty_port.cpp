#include "knee_robot/simulation/faulty_port.h"

#include "knee_robot/hardware/can/canopen.h"

namespace knee_robot::simulation {
namespace {

constexpr int kFlood = 200;
constexpr std::uint32_t kBusOffClass = 0x40;

bool isFeedback(const hardware::can::Frame& frame) noexcept {
  return !frame.error && frame.id > hardware::can::kTransmitPdoBase &&
         frame.id <= hardware::can::kTransmitPdoBase + hardware::can::kLargestNode;
}

}  // namespace

void FaultyPort::set(WireFault fault) noexcept {
  if (fault == fault_) return;
  fault_ = fault;
  is_held_.fill(false);
  count_.fill(0);
  if (fault != WireFault::BusOff) return;
  hardware::can::Frame frame;
  frame.error = true;
  frame.id = kBusOffClass;
  frame.length = 8;
  port_.send(frame);
}

hardware::can::PortStatus FaultyPort::send(const hardware::can::Frame& frame) noexcept {
  const std::size_t node = frame.id & 0x7F;
  switch (fault_) {
    case WireFault::None:
      break;
    case WireFault::Cut:
    case WireFault::BusOff:
      return hardware::can::PortStatus::Ok;
    case WireFault::Delayed:
      return isFeedback(frame) ? delay(frame, node) : port_.send(frame);
    case WireFault::Reordered:
      return isFeedback(frame) ? reorder(frame, node) : port_.send(frame);
    case WireFault::Flooded:
      return isFeedback(frame) ? flood(frame) : port_.send(frame);
  }
  return port_.send(frame);
}

hardware::can::PortStatus FaultyPort::delay(const hardware::can::Frame& frame, std::size_t node) noexcept {
  if (count_[node]++ % 3 == 0) {
    held_[node] = frame;
    is_held_[node] = true;
    return hardware::can::PortStatus::Ok;
  }
  if (is_held_[node]) port_.send(held_[node]);
  is_held_[node] = false;
  return port_.send(frame);
}

hardware::can::PortStatus FaultyPort::reorder(const hardware::can::Frame& frame, std::size_t node) noexcept {
  if (!is_held_[node]) {
    held_[node] = frame;
    is_held_[node] = true;
    return hardware::can::PortStatus::Ok;
  }
  is_held_[node] = false;
  port_.send(frame);
  return port_.send(held_[node]);
}

hardware::can::PortStatus FaultyPort::flood(const hardware::can::Frame& frame) noexcept {
  for (int i = 0; i < kFlood; ++i)
    port_.send(frame);
  return port_.send(frame);
}

hardware::can::PortStatus FaultyPort::receive(hardware::can::Frame& frame) noexcept {
  hardware::can::Frame fresh;
  const hardware::can::PortStatus status = port_.receive(fresh);
  if (status != hardware::can::PortStatus::Ok) return status;
  if (fault_ == WireFault::Cut || fault_ == WireFault::BusOff) return hardware::can::PortStatus::Empty;
  frame = fresh;
  return hardware::can::PortStatus::Ok;
}

}  // namespace knee_robot::simulation
