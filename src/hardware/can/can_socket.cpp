#include "knee_robot/hardware/can/can_socket.h"

#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "knee_robot/base/errors.h"

namespace knee_robot::hardware::can {
namespace {

std::int64_t clockNow(clockid_t clock) noexcept {
  timespec time{};
  ::clock_gettime(clock, &time);
  return time.tv_sec * 1'000'000'000LL + time.tv_nsec;
}

/// Descriptor that is closed unless it is released.
struct Guard {
  int descriptor;
  ~Guard() {
    if (descriptor >= 0) ::close(descriptor);
  }
  int release() { return std::exchange(descriptor, -1); }
};

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw InputError("CAN " + name + ": " + what);
}

int openInterface(const std::string& name, const std::vector<Filter>& filters) {
  Guard guard{::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)};
  if (guard.descriptor < 0) {
    refuse(name, std::string("this kernel offers no CAN (") + std::strerror(errno) +
                     "); load the module can-raw, or name the socket of a simulated bus by its path");
  }
  ifreq request{};
  if (name.empty() || name.size() >= sizeof request.ifr_name) refuse(name, "is no name of an interface");
  std::memcpy(request.ifr_name, name.c_str(), name.size() + 1);
  if (::ioctl(guard.descriptor, SIOCGIFINDEX, &request) != 0) refuse(name, "no such interface; ip link shows all");
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = request.ifr_ifindex;
  if (::ioctl(guard.descriptor, SIOCGIFFLAGS, &request) != 0 || (request.ifr_flags & IFF_UP) == 0) {
    refuse(name, "the interface is down; ip link set " + name + " up type can bitrate 1000000 restart-ms 100");
  }
  std::vector<can_filter> kernel_filters;
  for (const Filter& filter : filters)
    kernel_filters.push_back({filter.id, filter.mask | CAN_EFF_FLAG | CAN_RTR_FLAG});
  const can_err_mask_t errors = CAN_ERR_MASK;
  const int on = 1;
  const auto size = static_cast<socklen_t>(kernel_filters.size() * sizeof(can_filter));
  bool good =
      filters.empty() || ::setsockopt(guard.descriptor, SOL_CAN_RAW, CAN_RAW_FILTER, kernel_filters.data(), size) == 0;
  good = good && ::setsockopt(guard.descriptor, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) == 0;
  good = good && ::setsockopt(guard.descriptor, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) == 0;
  good = good && ::bind(guard.descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  if (!good) refuse(name, std::string("cannot be opened: ") + std::strerror(errno));
  return guard.release();
}

int connectPath(const std::string& path) {
  Guard guard{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) refuse(path, "the path is longer than 107 characters");
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  if (guard.descriptor < 0 || ::connect(guard.descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    refuse(path, std::string("no simulated bus answers there (") + std::strerror(errno) +
                     "); start one: cia402_simulator --bus " + path);
  }
  return guard.release();
}

PortStatus failed(int reason) noexcept {
  if (reason == EAGAIN || reason == EWOULDBLOCK || reason == EINTR) return PortStatus::Empty;
  if (reason == ENOBUFS) return PortStatus::Full;
  return PortStatus::Down;
}

/// The kernel stamps frames with the time of day. Their age is taken from it, so that only a clock that is set in just
/// this moment disturbs; an impossible age is taken for none.
std::int64_t stampOf(msghdr& message, std::int64_t monotonic) noexcept {
  for (cmsghdr* entry = CMSG_FIRSTHDR(&message); entry != nullptr; entry = CMSG_NXTHDR(&message, entry)) {
    if (entry->cmsg_level != SOL_SOCKET || entry->cmsg_type != SO_TIMESTAMPNS) continue;
    timespec time{};
    std::memcpy(&time, CMSG_DATA(entry), sizeof time);
    const std::int64_t age = clockNow(CLOCK_REALTIME) - (time.tv_sec * 1'000'000'000LL + time.tv_nsec);
    return age >= 0 && age < 1'000'000'000LL ? monotonic - age : monotonic;
  }
  return monotonic;
}

}  // namespace

bool fromKernel(const ::can_frame& raw, Frame& frame) noexcept {
  Frame fresh;
  fresh.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  fresh.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
  fresh.error = (raw.can_id & CAN_ERR_FLAG) != 0;
  fresh.id = raw.can_id & CAN_EFF_MASK;
  fresh.length = raw.can_dlc;
  if (raw.can_dlc > 8 || (!fresh.extended && !fresh.error && fresh.id > CAN_SFF_MASK)) return false;
  if (!fresh.remote) std::copy_n(raw.data, raw.can_dlc, fresh.data.begin());
  fresh.received_ns = frame.received_ns;
  frame = fresh;
  return true;
}

void toKernel(const Frame& frame, ::can_frame& raw) noexcept {
  raw = ::can_frame{};
  raw.can_id = frame.id & (frame.extended || frame.error ? CAN_EFF_MASK : CAN_SFF_MASK);
  if (frame.extended) raw.can_id |= CAN_EFF_FLAG;
  if (frame.remote) raw.can_id |= CAN_RTR_FLAG;
  if (frame.error) raw.can_id |= CAN_ERR_FLAG;
  raw.can_dlc = std::min<std::uint8_t>(frame.length, 8);
  std::copy_n(frame.data.begin(), raw.can_dlc, raw.data);
}

std::unique_ptr<CanSocket> CanSocket::open(const std::string& name, const std::vector<Filter>& filters) {
  const bool is_path = name.find('/') != std::string::npos;
  const int descriptor = is_path ? connectPath(name) : openInterface(name, filters);
  return std::unique_ptr<CanSocket>(new CanSocket(descriptor, filters, !is_path));
}

std::unique_ptr<CanSocket> CanSocket::adopt(int descriptor, const std::vector<Filter>& filters) {
  const int flags = ::fcntl(descriptor, F_GETFL);
  if (flags < 0 || ::fcntl(descriptor, F_SETFL, flags | O_NONBLOCK) != 0) throw InputError("CAN: no open socket");
  return std::unique_ptr<CanSocket>(new CanSocket(descriptor, filters, false));
}

CanSocket::~CanSocket() {
  ::close(descriptor_);
}

PortStatus CanSocket::send(const Frame& frame) noexcept {
  ::can_frame raw{};
  toKernel(frame, raw);
  const ssize_t count = ::send(descriptor_, &raw, sizeof raw, MSG_DONTWAIT | MSG_NOSIGNAL);
  if (count == static_cast<ssize_t>(sizeof raw)) return PortStatus::Ok;
  const PortStatus status = failed(count < 0 ? errno : 0);
  return status == PortStatus::Empty ? PortStatus::Full : status;
}

bool CanSocket::passes(const Frame& frame) const noexcept {
  if (kernel_can_ || frame.error || filters_.empty()) return true;
  if (frame.extended || frame.remote) return false;
  return std::any_of(filters_.begin(), filters_.end(),
                     [&](const Filter& filter) { return (frame.id & filter.mask) == (filter.id & filter.mask); });
}

PortStatus CanSocket::receive(Frame& frame) noexcept {
  constexpr int kMostForeign = 64;  // frames that the filters drop in one call: bounded time
  for (int i = 0; i < kMostForeign; ++i) {
    ::can_frame raw{};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof(timespec)) + 64];
    iovec part{&raw, sizeof raw};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
    const ssize_t count = ::recvmsg(descriptor_, &message, MSG_DONTWAIT);
    if (count < 0) return failed(errno);
    if (count == 0) return PortStatus::Down;  // the peer has closed
    Frame fresh;
    const bool whole = count == static_cast<ssize_t>(sizeof raw) && (message.msg_flags & MSG_TRUNC) == 0;
    if (!whole || !fromKernel(raw, fresh)) return PortStatus::Malformed;
    if (!passes(fresh)) continue;
    fresh.received_ns = stampOf(message, now());
    frame = fresh;
    return PortStatus::Ok;
  }
  return PortStatus::Empty;
}

std::int64_t CanSocket::now() noexcept {
  return clockNow(CLOCK_MONOTONIC);
}

void CanSocket::pause(std::int64_t duration_ns) {
  const timespec time{duration_ns / 1'000'000'000LL, duration_ns % 1'000'000'000LL};
  ::nanosleep(&time, nullptr);
}

}  // namespace knee_robot::hardware::can
