#pragma once

#include <string>

namespace knee_robot::hardware {

/// One controller and one guardian for a machine, whatever links, names and masters they were given: two that write the
/// same cards would undo each other's safe stops. An advisory lock on a file of the machine's name, and, as files can
/// be removed by whoever tidies up, a local socket of the file's name, which has none; the system lets go of both when
/// the process ends, however it ends. Processes in containers of their own do not see each other: give both the folder,
/// or the network.
class MachineLock {
 public:
  /// Takes `machine` for `role` ("controller", "guardian"). InputError names the machine, and the process that has it
  /// where it says so, or what the system refuses.
  static MachineLock take(const std::string& role, const std::string& machine, const std::string& folder = "/run/lock");

  /// Somebody has taken it; also told when whoever has it runs in another container of the same network. A look: whoever
  /// takes it at the same moment is not disturbed.
  static bool isTaken(const std::string& role, const std::string& machine, const std::string& folder = "/run/lock");

  MachineLock(MachineLock&& other) noexcept;
  MachineLock& operator=(MachineLock&& other) = delete;
  MachineLock(const MachineLock&) = delete;
  MachineLock& operator=(const MachineLock&) = delete;
  ~MachineLock();

 private:
  explicit MachineLock(int descriptor) noexcept : descriptor_(descriptor) {}
  int descriptor_;   // of the file
  int socket_ = -1;  // -1, too, where there can be none
};

}  // namespace knee_robot::hardware
