#include "knee_robot/hardware/machine_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "knee_robot/base/errors.h"

namespace knee_robot::hardware {
namespace {

std::string fileName(const std::string& role, const std::string& machine) {
  std::string name = "knee_robot_" + role + "_" + machine;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0 && c != '_' && c != '-'; }, '_');
  return name.substr(0, 200) + ".lock";
}

/// What the process that has the lock wrote of itself.
std::string holder(int descriptor) {
  char text[32] = {};
  const ssize_t size = ::pread(descriptor, text, sizeof text - 1, 0);
  const long pid = size > 0 ? std::strtol(text, nullptr, 10) : 0;
  return pid > 0 ? " (process " + std::to_string(pid) + ")" : "";
}

/// A name without a file ("abstract"): of the lock's file.
struct SocketName {
  explicit SocketName(const std::string& path) {
    address.sun_family = AF_UNIX;
    const std::string end = path.substr(path.size() - std::min(path.size(), sizeof address.sun_path - 1));
    end.copy(address.sun_path + 1, end.size());  // behind a zero
    size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + end.size());
  }
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }

  sockaddr_un address{};
  socklen_t size = 0;
};

/// Bound by one at a time. -1 with errno where it cannot be.
int bindTo(const std::string& path) {
  const SocketName name(path);
  const int made = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (made < 0 || ::bind(made, name.get(), name.size) == 0) return made;
  const int why = errno;
  ::close(made);
  errno = why;
  return -1;
}

}  // namespace

MachineLock MachineLock::take(const std::string& role, const std::string& machine, const std::string& folder) {
  const std::string path = folder + "/" + fileName(role, machine);
  // Whoever may read it may lock it: another user's controller counts, too.
  int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (descriptor < 0 && errno == EACCES) descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0) throw InputError(path + ": cannot be opened: " + std::strerror(errno));
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    const bool taken = errno == EWOULDBLOCK;
    const std::string why =
        taken ? "another " + role + holder(descriptor) + " has the machine " + machine + " already; end it first"
              : path + ": cannot be locked: " + std::strerror(errno);
    ::close(descriptor);
    throw InputError(why);
  }
  MachineLock lock(descriptor);
  lock.socket_ = bindTo(path);
  if (lock.socket_ < 0 && errno == EADDRINUSE)
    throw InputError("another " + role + " has the machine " + machine + " already (its file " + path +
                     " was removed); end it first");
  const std::string mine = std::to_string(::getpid()) + "\n";
  if (::ftruncate(descriptor, 0) == 0 && ::pwrite(descriptor, mine.data(), mine.size(), 0) < 0) {
    // read only: nobody learns the number, the lock holds all the same
  }
  return lock;
}

bool MachineLock::isTaken(const std::string& role, const std::string& machine, const std::string& folder) {
  const SocketName name(folder + "/" + fileName(role, machine));
  const int made = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool taken = made >= 0 && ::connect(made, name.get(), name.size) == 0;
  if (made >= 0) ::close(made);
  return taken;
}

MachineLock::MachineLock(MachineLock&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), socket_(std::exchange(other.socket_, -1)) {}

MachineLock::~MachineLock() {
  for (const int one : {socket_, descriptor_}) {
    if (one >= 0) ::close(one);
  }
}

}  // namespace knee_robot::hardware
