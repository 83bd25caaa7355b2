// Whom the kernel ends where memory runs out.
#include "src/nodes/out_of_memory.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

namespace knee_robot::nodes {
namespace {

int ownAdjustment() {
  int found = 1;
  std::ifstream("/proc/self/oom_score_adj") >> found;
  return found;
}

TEST(OutOfMemory, OthersAreEndedFirstWhereThatMayBeAskedForAndNothingHappensElsewhere) {
  const int before = ownAdjustment();
  const pid_t child = ::fork();
  if (child == 0) {
    endOthersFirst(kLast);
    const int now = ownAdjustment();
    ::_exit(now == kLast || now == before ? 0 : 1);  // root in a container may have no right to it either
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace knee_robot::nodes
