#include "out_of_memory.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>

namespace knee_robot::nodes {

void endOthersFirst(int adjustment) noexcept {
  char text[16];
  const int length = std::snprintf(text, sizeof text, "%d\n", adjustment);
  const int file = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (file < 0) return;
  const bool granted = ::write(file, text, static_cast<std::size_t>(length)) == length;
  ::close(file);
  (void)granted;
}

}  // namespace knee_robot::nodes
