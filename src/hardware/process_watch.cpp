#include "knee_robot/hardware/process_watch.h"

#include <poll.h>
#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>

namespace knee_robot::hardware {

ProcessWatch::~ProcessWatch() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void ProcessWatch::follow(std::int32_t pid) noexcept {
  if (descriptor_ >= 0) ::close(descriptor_);
  pid_ = pid;
  descriptor_ = -1;
  gone_ = false;
  if (pid <= 0) return;
  descriptor_ = static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
  gone_ = descriptor_ < 0 && errno == ESRCH;
}

bool ProcessWatch::isGone(std::int32_t pid) noexcept {
  if (pid != pid_) follow(pid);
  if (pid_ <= 0 || gone_) return gone_;
  if (descriptor_ >= 0) {
    pollfd ended{descriptor_, POLLIN, 0};
    gone_ = ::poll(&ended, 1, 0) == 1 && (ended.revents & POLLIN) != 0;
  } else {
    gone_ = ::kill(pid_, 0) != 0 && errno == ESRCH;
  }
  return gone_;
}

}  // namespace knee_robot::hardware
