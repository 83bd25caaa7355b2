#pragma once

#include <cstdint>

namespace knee_robot::hardware {

/// Says at once when a process is gone, zombies included (kill(pid, 0) finds those alive), and is not fooled by a
/// number that is used again: it polls a pidfd (Linux 5.3). Without pidfd it falls back on kill(pid, 0). Two short
/// system calls at most.
class ProcessWatch {
 public:
  ProcessWatch() = default;
  ~ProcessWatch();
  ProcessWatch(const ProcessWatch&) = delete;
  ProcessWatch& operator=(const ProcessWatch&) = delete;

  /// True when `pid` has ended. 0 is nobody, who is never gone. Another pid than before: watches that one from now on.
  bool isGone(std::int32_t pid) noexcept;

 private:
  void follow(std::int32_t pid) noexcept;

  std::int32_t pid_ = 0;
  int descriptor_ = -1;
  bool gone_ = false;
};

}  // namespace knee_robot::hardware
