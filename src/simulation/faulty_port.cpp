#include "knee_robot/simulation/faulty_port.h"

#include "knee_robot/hardware/can/canopen.h"

namespace knee_robot::hardware::can {
namespace {

constexpr int kFlood = 200;
constexpr std::uint32_t kBusOffClass = 0x40;

bool isFeedback(const Frame& frame) noexcept {
  return !frame.error && frame.id > kTransmitPdoBase && frame.id <= kTransmitPdoBase + kLargestNode;
}

}  // namespace

void FaultyPort::set(WireFault fault) noexcept {
  if (fault == fault_) return;
  fault_ = fault;
  is_held_.fill(false);
  count_.fill(0);
  if (fault != WireFault::BusOff) return;
  Frame frame;
  frame.error = true;
  frame.id = kBusOffClass;
  frame.length = 8;
  port_.send(frame);
}

PortStatus FaultyPort::send(const Frame& frame) noexcept {
  const std::size_t node = frame.id & 0x7F;
  switch (fault_) {
    case WireFault::None:
      break;
    case WireFault::Cut:
    case WireFault::BusOff:
      return PortStatus::Ok;
    case WireFault::Delayed:
      return isFeedback(frame) ? delay(frame, node) : port_.send(frame);
    case WireFault::Reordered:
      return isFeedback(frame) ? reorder(frame, node) : port_.send(frame);
    case WireFault::Flooded:
      return isFeedback(frame) ? flood(frame) : port_.send(frame);
  }
  return port_.send(frame);
}

PortStatus FaultyPort::delay(const Frame& frame, std::size_t node) noexcept {
  if (count_[node]++ % 3 == 0) {
    held_[node] = frame;
    is_held_[node] = true;
    return PortStatus::Ok;
  }
  if (is_held_[node]) port_.send(held_[node]);
  is_held_[node] = false;
  return port_.send(frame);
}

PortStatus FaultyPort::reorder(const Frame& frame, std::size_t node) noexcept {
  if (!is_held_[node]) {
    held_[node] = frame;
    is_held_[node] = true;
    return PortStatus::Ok;
  }
  is_held_[node] = false;
  port_.send(frame);
  return port_.send(held_[node]);
}

PortStatus FaultyPort::flood(const Frame& frame) noexcept {
  for (int i = 0; i < kFlood; ++i)
    port_.send(frame);
  return port_.send(frame);
}

PortStatus FaultyPort::receive(Frame& frame) noexcept {
  Frame fresh;
  const PortStatus status = port_.receive(fresh);
  if (status != PortStatus::Ok) return status;
  if (fault_ == WireFault::Cut || fault_ == WireFault::BusOff) return PortStatus::Empty;
  frame = fresh;
  return PortStatus::Ok;
}

}  // namespace knee_robot::hardware::can
