#include "knee_robot/simulation/bus_server.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "knee_robot/base/errors.h"

namespace knee_robot::simulation {
namespace {

constexpr std::size_t kMostPeers = 16;

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
  throw InputError("simulated CAN bus " + path + ": " + what);
}

bool isServed(const sockaddr_un& address) {
  const int probe = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  const bool served = ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(probe);
  return served;
}

}  // namespace

BusServer::BusServer(const std::string& path) : path_(path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) refuse(path, "the path must have 1 to 107 characters");
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  if (isServed(address)) refuse(path, "somebody serves it already; end that or choose another path");
  ::unlink(path.c_str());
  listener_ = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 || ::listen(listener_, 8) != 0) {
    const int reason = errno;
    ::close(listener_);
    refuse(path, std::string("cannot be opened: ") + std::strerror(reason));
  }
}

BusServer::~BusServer() {
  ::close(listener_);
  ::unlink(path_.c_str());
}

void BusServer::accept() {
  while (peers_.size() < kMostPeers) {
    const int descriptor = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (descriptor < 0) return;
    if (hung_up_) {
      ::close(descriptor);
      continue;
    }
    peers_.push_back(hardware::can::CanSocket::adopt(descriptor, {}));
  }
}

void BusServer::hangUp(bool on) {
  hung_up_ = on;
  if (on) peers_.clear();
}

void BusServer::forward(const hardware::can::Frame& frame, const hardware::can::CanSocket* sender) noexcept {
  for (const auto& peer : peers_)
    if (peer.get() != sender) peer->send(frame);
}

hardware::can::PortStatus BusServer::send(const hardware::can::Frame& frame) noexcept {
  forward(frame, nullptr);
  return hardware::can::PortStatus::Ok;
}

hardware::can::PortStatus BusServer::receive(hardware::can::Frame& frame) noexcept {
  for (std::size_t tried = 0; tried < peers_.size();) {
    next_ = next_ % peers_.size();
    const hardware::can::CanSocket* sender = peers_[next_].get();
    const hardware::can::PortStatus status = peers_[next_].get()->receive(frame);
    if (status == hardware::can::PortStatus::Ok) {
      ++next_;
      forward(frame, sender);
      return status;
    }
    if (status == hardware::can::PortStatus::Down) {
      peers_.erase(peers_.begin() + static_cast<std::ptrdiff_t>(next_));
      continue;
    }
    if (status == hardware::can::PortStatus::Empty) {
      ++next_;
      ++tried;
    }
  }
  return hardware::can::PortStatus::Empty;
}

std::int64_t BusServer::now() noexcept {
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * 1'000'000'000LL + time.tv_nsec;
}

void BusServer::pause(std::int64_t duration_ns) {
  wait(now() + duration_ns);
}

void BusServer::wait(std::int64_t deadline_ns) {
  watched_.clear();
  watched_.push_back({listener_, POLLIN, 0});
  for (const auto& peer : peers_)
    watched_.push_back({peer->descriptor(), POLLIN, 0});
  const std::int64_t left = std::max<std::int64_t>(0, deadline_ns - now());
  const timespec time{left / 1'000'000'000LL, left % 1'000'000'000LL};
  ::ppoll(watched_.data(), watched_.size(), &time, nullptr);
  accept();
}

}  // namespace knee_robot::simulation
