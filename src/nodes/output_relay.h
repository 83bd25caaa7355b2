#pragma once

#include <memory>
#include <vector>

namespace knee_robot::nodes {

/// While it lives, writing to stdout and stderr of this process waits for nobody. A terminal that was stopped with
/// Ctrl-S, a pipe whose reader hangs or a service manager that waits for its disk would otherwise hold up every thread
/// that logs, and with it a stop or an emergency stop. A thread hands on what is written; what finds no room is lost.
/// Files and /dev/null are left as they are.
class OutputRelay {
 public:
  OutputRelay();
  /// Waits a second at most for whoever reads.
  ~OutputRelay();
  OutputRelay(const OutputRelay&) = delete;
  OutputRelay& operator=(const OutputRelay&) = delete;

 private:
  class Stream;
  std::vector<std::shared_ptr<Stream>> streams_;
};

}  // namespace knee_robot::nodes
